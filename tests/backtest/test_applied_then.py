"""A back-test of a stretch tells what would have been, had the table been applied at its start."""

from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import strategies as st

from kompass.backtest.engine import backtest
from kompass.backtest.event_log import Heard, LoggedEvent, Resumed
from kompass.recorder.engine_memory import EngineMemory
from kompass.rules.schema.table import Rule, Table
from tests.backtest.live_loop import FLOAT, NS, LiveLoop
from tests.rules.building import compare, rule
from tests.rules.strategies import GRID, callable_samples, samples, tables
from tests.support.properties import MANY, property_test

happenings = st.one_of(samples, samples, samples, callable_samples)
streams = st.lists(
    st.tuples(st.sampled_from((0, 1, 1, 2, 2, 3, 4, 8, 13)), happenings), max_size=25
)


def play(monitor: LiveLoop, stream: list[Any]) -> None:
    for gap, (topic, message) in stream:
        monitor.say(topic, message, gap * GRID)


def parked(monitor: LiveLoop, seconds: float) -> None:
    """Say ten times a second that the nearest obstacle is 0.41 m away."""
    for _ in range(round(seconds * 10)):
        monitor.say("scan", SimpleNamespace(x=0.41), 0.1)


def resumed_at(monitor: LiveLoop) -> Resumed:
    """What a stretch of the recording begins with that begins now."""
    memory = EngineMemory()
    for event in monitor.log:
        if not isinstance(event, Heard):
            memory.take(event)
    resumed = memory.resumed(monitor.now_ns * 1e-9)
    assert resumed is not None
    return resumed


def too_near(**event: Any) -> Rule:
    return rule(compare("scan", "<", 0.5), "too-near", **event)


@pytest.mark.parametrize("listened", [True, False], ids=["heard", "not listened to before"])
@pytest.mark.parametrize("trigger", ["edge", "level"])
def test_what_was_true_for_minutes_fires_its_hold_after_the_start_of_the_stretch(
    trigger: str, listened: bool
) -> None:
    other = rule(compare("scan" if listened else "battery", ">", 9), "other")
    monitor = LiveLoop(Table(rules=(other,)))
    parked(monitor, 60.0)
    resumed, begun = resumed_at(monitor), len(monitor.log)
    newest: list[LoggedEvent] = []
    if listened:  # a clip repeats what was valid when it begins
        message = SimpleNamespace(x=0.41)
        newest = [Heard(resumed.now, "scan", FLOAT, message, again=True)]
    parked(monitor, 10.0)
    stretch: list[LoggedEvent] = [resumed, *newest, *monitor.log[begun:]]
    proposed = Table(rules=(other, too_near(trigger=trigger, hold=2.0, once=True)))

    report = backtest(proposed, stretch, stretch)

    assert [(f.rule_id, f.verdict) for f in report.firings] == [("too-near", "new")]
    # The hold begins with the first message that the table takes.
    assert report.firings[0].at == pytest.approx(2.1)


def proposed_firings(report: Any) -> list[tuple[str, float]]:
    """What the back-test says that the table would have fired, in its order of time."""
    return [(f.rule_id, round(f.time, 6)) for f in report.firings if f.verdict != "gone"]


def really_fired(monitor: LiveLoop, revision: int) -> list[tuple[str, float]]:
    offset = monitor.loop.wall_offset
    return [(f.rule_id, round(f.at + offset, 6)) for f, by in monitor.fired if by >= revision]


def mixed(old: Table, new: Table, kept: list[bool]) -> Table:
    """The new table, with some rules as they were: those are carried on."""
    rules = list(new.rules)
    for index, (before, keep) in enumerate(zip(old.rules, kept, strict=False)):
        if keep:
            rules[index : index + 1] = [before]
    return Table(rules=tuple(rules))


@property_test(
    tables(),
    tables(),
    tables(max_rules=2),
    st.lists(st.booleans(), max_size=4),
    streams,
    streams,
    st.sampled_from((0, 1, 2, 5)),
    st.sampled_from((0.0, 0.0, 0.0625, 0.3)),
    many=MANY * 2,
)
def test_applied_in_reality_and_back_tested_from_then_fires_the_same(
    old: Table,
    new: Table,
    other: Table,
    kept: list[bool],
    first: list[Any],
    second: list[Any],
    pause: int,
    length: float,
) -> None:
    """For any tables, recording and moment: firing by firing, up to the first that is assumed.

    Other tables were applied before that moment, and after it, too.
    """
    new = mixed(old, new, kept)
    recorded, real = LiveLoop(other, length), LiveLoop(other, length)
    for monitor in (recorded, real):
        play(monitor, first[: len(first) // 3])
        monitor.apply(old)
        play(monitor, first[len(first) // 3 :])
        monitor.pass_time(monitor.now_ns + pause * NS // 8)
    before, begun = list(recorded.log), len(recorded.log)
    resumed = resumed_at(recorded)
    real.apply(new)
    for monitor in (recorded, real):
        play(monitor, second[: len(second) // 2])
        if monitor is recorded and len(kept) > 1:
            monitor.apply(other)
        play(monitor, second[len(second) // 2 :])
    real.pass_time(real.now_ns)  # what is due at the very moment of the end
    stretch: list[LoggedEvent] = [resumed, *recorded.log[begun:]]

    report = backtest(new, stretch, stretch, before=before)

    # Runs that last no time are taken to last none: then nothing rests on a guess.
    assumed = [round(f.time, 6) for f in report.firings if f.assumed and length]
    until = min(assumed, default=float("inf"))
    said = [each for each in proposed_firings(report) if each[1] < until]
    # The recording ends with its last message: what time alone brings later is not judged.
    end = min(until, round(report.end, 6) + 1e-7)
    assert sorted(said) == sorted(each for each in really_fired(real, 3) if each[1] < end)
