"""What the event log takes down is what the engine took: a replay of it fires the same."""

import json
from typing import Any

from hypothesis import given, settings
from hypothesis import strategies as st
from rclpy.serialization import deserialize_message, serialize_message
from std_msgs.msg import Int32

from kompass.backtest.engine import backtest
from kompass.backtest.event_log import Fired, Heard, LoggedEvent, from_data
from kompass.monitor.engine_loop import EngineLoop
from kompass.rules.engine.compiled_table import CompiledTable, compile_table
from kompass.rules.engine.firing import Firing, Output
from kompass.rules.engine.migration import plan_migration
from kompass.rules.schema.table import Table
from tests.support.clock import SetClock
from tests.support.rules import compare, rule, signal


class EventList:
    """Keeps what it is given as it would come from a file."""

    def __init__(self) -> None:
        self.events: list[LoggedEvent] = []

    def message(self, topic: str, type_name: str, raw: bytes, now_ns: int) -> None:
        message = deserialize_message(raw, Int32)
        self.events.append(Heard(now_ns * 1e-9, topic, type_name, message))

    def event(self, kind: str, data: dict[str, Any], now_ns: int) -> None:
        self.events.append(from_data(kind, json.loads(json.dumps(data))))

    def text(self, kind: str, text: str, now_ns: int) -> None:
        self.events.append(from_data(kind, json.loads(text)))


class World:
    """An engine loop on a clock that is moved by hand; runs end when they are told to."""

    def __init__(self, table: Table) -> None:
        self.now = 5_000_000_123
        self.event_log = EventList()
        self.firings: list[Firing] = []
        self.revisions: list[int] = []  # of the table that let each of them fire
        self.deadline: float | None = None
        self.loop = EngineLoop(
            compile_table(table),
            1,
            "session",
            handle=self._handle,
            wake=self._wake,
            event_log=self.event_log,
            clock=SetClock(lambda: self.now, 1_700_000_000.0),
        )
        self.loop.begin()

    def _handle(self, outputs: list[Output], table: CompiledTable, revision: int) -> None:
        self.firings += [each for each in outputs if isinstance(each, Firing)]
        self.revisions += [revision for each in outputs if isinstance(each, Firing)]
        assert all(each.rule_id in table.by_id for each in outputs)

    def _wake(self, at: float | None) -> None:
        self.deadline = at

    def say(self, topic: str, value: int) -> None:
        raw = serialize_message(Int32(data=value))
        self.loop.heard(topic, "std_msgs/msg/Int32", Int32(data=value), raw)

    def wait(self, ns: int) -> None:
        self.now += ns
        if self.deadline is not None and self.deadline <= self.now * 1e-9:
            self.loop.tick()


RULES = [
    rule("level", compare("a", ">", 2), cooldown=0.3),
    rule("held", compare("a", ">", 1), hold=0.2, trigger="edge"),
    rule("silent", {"kind": "absent", "signal": signal("b"), "seconds": 0.4}, trigger="edge"),
    rule("changed", {"kind": "changed", "signal": signal("b")}, mode={"kind": "queued", "size": 2}),
    rule("once", compare("b", "==", 3), once=True),
]
STEPS = st.lists(
    st.one_of(
        st.tuples(st.just("a"), st.integers(0, 4)),
        st.tuples(st.just("b"), st.integers(0, 4)),
        st.tuples(st.just("wait"), st.integers(1, 600_000_000)),
        st.tuples(st.just("end"), st.integers(0, 3)),
        st.tuples(st.just("swap"), st.integers(0, 4)),
    ),
    max_size=40,
)


@settings(max_examples=30, deadline=None)
@given(steps=STEPS)
def test_a_replay_of_the_log_fires_at_the_same_times_for_the_same_reasons(
    steps: list[tuple[str, int]],
) -> None:
    table = Table.model_validate({"rules": RULES})
    world = World(table)
    ended = 0
    swapped = False
    for what, number in steps:
        if what == "wait":
            world.wait(number)
        elif what == "end" and ended < len(world.firings):
            run = world.firings[ended]
            world.loop.ended(run.rule_id, run.run_id, number > 0, "" if number else "failed")
            ended += 1
        elif what == "swap":
            # Away and back again: what was reset in between must be reset in the replay too.
            others = [each for place, each in enumerate(RULES) if place != number]
            for rules in (others, RULES):
                new = compile_table(Table.model_validate({"rules": rules}))
                world.loop.swap(plan_migration(world.loop.table, new), world.loop.revision + 1)
            swapped = True
        elif what in ("a", "b"):
            world.wait(1_000_000)
            world.say(what, number)
    fired = [event for event in world.event_log.events if isinstance(event, Fired)]
    assert [(f.rule_id, f.run_id) for f in fired] == [(f.rule_id, f.run_id) for f in world.firings]
    if swapped:
        return  # a back-test is of one table; that the log is whole is shown above
    recorded = [event for event in world.event_log.events if not isinstance(event, Heard)]
    report = backtest(table, world.event_log.events, recorded)
    assert (report.same, report.new, report.gone) == (len(fired), 0, 0)


def test_a_swap_is_logged_after_what_the_old_table_let_fire() -> None:
    world = World(Table.model_validate({"rules": RULES}))
    world.say("b", 1)
    world.now += 1_000_000_000  # silence is due, and nobody has woken the engine up
    empty = compile_table(Table())
    world.loop.swap(plan_migration(world.loop.table, empty), 2)
    assert [type(event).__name__ for event in world.event_log.events][-2:] == ["Fired", "Swapped"]
    fired = world.event_log.events[-2]
    assert isinstance(fired, Fired)
    assert (fired.rule_id, fired.revision) == ("silent", 1)
    # It is not the new table's, though that is in force when it is carried out.
    assert (world.firings[-1].rule_id, world.revisions[-1]) == ("silent", 1)
    assert world.loop.revision == 2


def test_a_message_is_logged_before_what_it_made_fire_and_that_before_its_end() -> None:
    class AtOnce(World):
        """Runs end while the engine's output is being handled."""

        def _handle(self, outputs: list[Output], table: CompiledTable, revision: int) -> None:
            super()._handle(outputs, table, revision)
            for each in outputs:
                if isinstance(each, Firing):
                    self.loop.ended(each.rule_id, each.run_id, True, "")

    world = AtOnce(Table.model_validate({"rules": [rule("level", compare("a", ">", 2))]}))
    world.say("a", 3)
    kinds = [type(event).__name__ for event in world.event_log.events]
    assert kinds == ["Began", "Heard", "Fired", "Ended"]
