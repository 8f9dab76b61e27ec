"""Tables and entries for tests of the store."""

from pathlib import Path
from typing import Any, TypedDict

import pytest

from kompass.rulebook.schema.journal import FiringRecord
from kompass.rules.schema.actions import Log
from kompass.rules.schema.table import Table
from kompass.store.boot import Boot
from kompass.store.store import RuleStore
from tests.rules.building import received, rule

RECIPE = Table(rules=(rule(received("click"), "click", source="recipe"),))


class By(TypedDict):
    """Who changes the store."""

    author: str
    role: str


BY: By = {"author": "ava", "role": "engineer"}


def edited(text: str, base: Table = RECIPE) -> Table:
    """A table with a rule that nobody else has."""
    return Table(rules=(*base.rules, rule(received("scan"), "more", actions=(Log(text=text),))))


class Clock:
    """Seconds since the epoch, as a test wants them."""

    def __init__(self, now: float = 1_800_000_000.0) -> None:
        self.now = now

    def __call__(self) -> float:
        return self.now


class Robot:
    """A store that is opened, killed and opened again."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.clock, self.sessions = folder, Clock(), 0
        self.recipe = RECIPE
        self.store: RuleStore
        self.boot: Boot

    def start(self, *, safe_mode: bool = False, stack: str = "stack") -> Boot:
        self.sessions += 1
        self.store = RuleStore.open(self.folder, clock=self.clock)
        self.boot = self.store.begin_session(
            self.recipe, epoch=f"life {self.sessions}", stack=stack, safe_mode=safe_mode
        )
        return self.boot

    def crash(self) -> None:
        """The monitor ends without saying so."""
        self.store.close()

    def stop(self) -> None:
        self.store.end_session()
        self.store.close()

    def outcomes(self) -> dict[int, str]:
        return {r.number: r.outcome for r in self.store.history().revisions}


@pytest.fixture
def robot(tmp_path: Path) -> Any:
    made = Robot(tmp_path / "robot")
    yield made
    if hasattr(made, "store"):
        made.store.close()


def entry(rule_id: str = "click", **fields: Any) -> FiringRecord:
    """An entry of the journal."""
    return FiringRecord.model_validate(
        {
            "number": 0,
            "epoch": "life 1",
            "run_id": 1,
            "rule_id": rule_id,
            "name": "",
            "kind": "firing",
            "time": 1_800_000_000.0,
            "revision": 1,
            "rule_hash": "0" * 16,
            "severity": "warning",
            **fields,
        }
    )
