"""A person who edits the rules of a robot that drives, and remembers what was acknowledged."""

from __future__ import annotations

import json
import random
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from kompass_interfaces.msg import RulesState
from kompass_interfaces.srv import (
    ApplyRules,
    CheckRules,
    ConfirmRules,
    GetRules,
    RollbackRules,
)

from kompass.access.signer import Signer
from kompass.rclpy_ext.qos import LATCHED_PROFILE
from kompass.rclpy_ext.reply import Reply
from kompass.rules.schema.table import Table
from kompass.store.robot_key import known_keys
from kompass.store.store import RuleStore
from kompass.virtual.node import VirtualNode
from tests.drills.probes import BEAT, HELD

PERIOD = 0.02  # s between two looks at what is due
PATIENCE = 3.0  # s after which an answer is not waited for any more
CRASHES = 2  # of the monitor after which a table that was new is taken back
PROBATION = 2.0  # s
WHO = {"author": "ava", "role": "engineer"}
_SERVICES: dict[Any, str] = {
    GetRules: "get_rules",
    ApplyRules: "apply_rules",
    ConfirmRules: "confirm_rules",
    RollbackRules: "rollback_rules",
    CheckRules: "check_rules",
}
_COMPONENTS = ("planner", "controller", "mapper", "drive_manager")


@dataclass(frozen=True)
class Edit:
    """Something that the person does.

    Attributes
    ----------
    kind
        ``apply`` for good; ``try`` on probation, and forget it; ``confirm``: try, and keep it;
        ``rollback``; ``bad``: a table with a fault; ``stale``: one that begins from another
        revision; ``check``.
    """

    at: float
    kind: str
    seed: int


class Editor:
    """Carries edits out, over the services that a person's console uses."""

    def __init__(self, node: VirtualNode, edits: Sequence[Edit], now: Callable[[], float]) -> None:
        self._now, self._edits = now, list(edits)
        self._signer = Signer(node, "/monitor", known_keys())
        self._clients = {
            kind: (node.create_client(kind, f"/monitor/{name}"), f"/monitor/{name}")
            for kind, name in _SERVICES.items()
        }
        self._open: list[tuple[float, Reply[Any]]] = []
        self._kept: dict[int, str] = {}  # tables by their revisions, as acknowledged
        self._floor = 0  # the last revision of which it was acknowledged that it is kept
        self._came_back = False
        # Of each monitor that was started again: what it has in force, and what it must have kept.
        self._begun_with: list[tuple[int, int]] = []
        self._found: list[str] = []
        self._states: list[RulesState] = []
        self.answers = 0
        node.create_subscription(RulesState, "/monitor/rules_state", self._hear, LATCHED_PROFILE)
        node.create_timer(PERIOD, self._look)

    def monitor_changed(self, state: str) -> None:
        """The supervisor tells of the monitor's process."""
        if state == "starting":
            self._came_back = True

    def _hear(self, state: RulesState) -> None:
        self._states.append(state)
        if self._came_back:
            self._came_back = False
            self._begun_with.append((int(state.revision), self._floor))

    def _look(self) -> None:
        now = self._now()
        while self._edits and 0.0 <= self._edits[0].at <= now:
            self._begin(self._edits.pop(0))
        for at, reply in list(self._open):
            reply.begin()
            if reply.done() or now - at > PATIENCE:
                self._open.remove((at, reply))

    def _ask(self, kind: Any, heard: Callable[[Any], object], **fields: Any) -> None:
        client, service = self._clients[kind]
        reply: Reply[Any] = self._signer.call(client, service, kind.Request(**fields), None)

        def note(done: Reply[Any]) -> None:
            try:
                heard(done.result())
            except Exception as error:  # noqa: BLE001 - a future tells nobody of it
                self._found.append(f"an answer was not understood: {error!r}")

        reply.add_done_callback(note)  # type: ignore[arg-type]
        self._open.append((self._now(), reply))

    def _begin(self, edit: Edit) -> None:
        if edit.kind == "rollback":
            self._ask(RollbackRules, self._rolled_back, **WHO)
            return
        self._ask(GetRules, lambda answer: self._edit(edit, answer))

    def _edit(self, edit: Edit, answer: Any) -> None:
        if not answer.success:
            self._found.append(f"the table was not told: {answer.message}")
            return
        view = json.loads(answer.answer)
        rng = random.Random(edit.seed)
        rules = changed(view["table"]["rules"], rng)
        expected = view["revision"]
        if edit.kind == "bad":
            rules.append({**rules[0], "id": "No Id"})
        text = json.dumps({**view["table"], "rules": rules})
        if edit.kind == "check":
            self._ask(CheckRules, self._checked, table=text, role="engineer")
            return
        if edit.kind == "stale":
            expected += 1000
        probation = 0.0 if edit.kind == "apply" else PROBATION
        self._ask(
            ApplyRules,
            lambda answer: self._applied(edit, text, answer),
            table=text,
            expected_revision=expected,
            probation=probation,
            cancel_running=rng.random() < 0.3,
            **WHO,
        )

    def _checked(self, answer: Any) -> None:
        self.answers += 1
        if not answer.success and not answer.answer:
            self._found.append(f"a check failed: {answer.message}")

    def _applied(self, edit: Edit, text: str, answer: Any) -> None:
        self.answers += 1
        wanted = {"bad": (2,), "stale": (1, 2)}.get(edit.kind, (0, 1))
        if answer.outcome not in wanted:
            self._found.append(
                f"{edit.kind} at {edit.at:g} s came out as {answer.outcome}: {answer.message}"
            )
        if answer.outcome != ApplyRules.Request.APPLIED:
            return
        revision = int(answer.revision)
        self._kept[revision] = text
        if edit.kind == "apply":
            self._floor = max(self._floor, revision)
        if edit.kind == "confirm":
            self._ask(
                ConfirmRules,
                lambda answer: self._confirmed(revision, answer),
                revision=revision,
                **WHO,
            )

    def _confirmed(self, revision: int, answer: Any) -> None:
        self.answers += 1
        if answer.success:
            self._floor = max(self._floor, revision)

    def _rolled_back(self, answer: Any) -> None:
        self.answers += 1
        if answer.outcome == ApplyRules.Request.FAILED:
            self._found.append(f"a rollback failed: {answer.message}")

    @property
    def is_told(self) -> bool:
        """Whether the monitor has said what is in force, if it was started again."""
        return not self._came_back

    def finish(self) -> None:
        """The drive is over, and the monitor was started once more."""
        if self._came_back:
            self._found.append("the monitor that was started again never said what is in force")

    def findings(self) -> list[str]:
        """What was not as it must be."""
        return self._found

    def lost_in(self, store: RuleStore) -> Iterator[str]:
        """What was acknowledged and is not on the disk, or is another there."""
        for revision, text in self._kept.items():
            sent = Table.model_validate_json(text)
            try:
                kept = store.table(revision)
            except LookupError as error:
                yield f"revision {revision} was acknowledged, and is lost: {error}"
                continue
            if _plain(kept) != _plain(sent):
                yield f"revision {revision} is not the table that was acknowledged"
        for starts, (revision, floor) in enumerate(self._begun_with, 1):
            if starts >= CRASHES and store.revision(revision).origin == "taken back":
                continue  # it was put down to the table that the monitor died so soon, and so often
            # Or what somebody made of it later, of which the answer was on its way.
            made = [
                number
                for number in range(max(floor, 1), revision + 1)
                if number == floor or store.revision(number).origin in ("edit", "rollback")
            ]
            in_force = _plain(store.table(revision))
            if floor and all(_plain(store.table(number)) != in_force for number in made):
                yield (
                    f"a monitor that was started again has revision {revision} in force, and not "
                    f"what was acknowledged as revision {floor}"
                )


def _plain(table: Table) -> list[dict[str, Any]]:
    return [rule.model_dump(mode="json", exclude={"source"}) for rule in table.rules]


def changed(rules: list[dict[str, Any]], rng: random.Random) -> list[dict[str, Any]]:
    """A table with some changes, none of them to the probes."""
    rules = json.loads(json.dumps(rules))
    for _ in range(rng.choice((1, 1, 2, 4))):
        others = [rule for rule in rules if rule["id"] not in (HELD, BEAT)]
        kind = rng.choice(("add", "add", "drop", "copy", "cooldown", "enabled", "shadow", "order"))
        if kind == "add" or not others:
            rules.append(_new_rule(rng))
            continue
        rule = rng.choice(others)
        if kind == "drop":
            rules.remove(rule)
        elif kind == "copy":
            rules.append({**rule, "id": f"copy-{rng.randrange(10**9)}"})
        elif kind == "cooldown":
            rule["event"]["cooldown"] = rng.choice((0.0, 0.5, 5.0))
        elif kind == "order":
            rng.shuffle(rules)
        else:
            rule[kind] = not rule.get(kind, kind == "enabled")
    return rules


def _new_rule(rng: random.Random) -> dict[str, Any]:
    whose = rng.choice(_COMPONENTS)
    status = {
        "kind": "compare",
        "signal": {
            "topic": f"{whose}/status",
            "type": "automatika_ros_sugar/msg/ComponentStatus",
            "path": ["status"],
        },
        "operator": rng.choice(("!=", "==")),
        "value": 0,
    }
    event = {
        "condition": status,
        "trigger": rng.choice(("level", "edge")),
        "hold": rng.choice((0.0, 0.3, 1.0)),
        "cooldown": rng.choice((0.5, 2.0)),
    }
    call = rng.choice(
        (
            {"kind": "method", "component": "drive_manager", "method": "move_to_unblock"},
            {"kind": "method", "component": "drive_manager", "method": "rotate_in_place",
             "kwargs": {"max_rotation": 0.5}},
            {"kind": "lifecycle", "component": rng.choice(_COMPONENTS), "action": "restart"},
            {"kind": "lifecycle", "component": "controller", "action": "stop"},
        )
    )  # fmt: skip
    actions = rng.choice(
        (
            [{"kind": "log", "text": "hm"}],
            [call],
            [{"kind": "log", "text": "hm"}, call],
        )
    )
    return {"id": f"new-{rng.randrange(10**9)}", "event": event, "actions": actions}
