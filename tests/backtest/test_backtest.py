"""A back-test fires as reality did, and differs exactly where the table differs."""

from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import strategies as st

from kompass.backtest.engine import backtest
from kompass.backtest.event_log import Began, Ended, Fired, Heard, LoggedEvent, Resumed, Swapped
from kompass.rules.schema.actions import Log
from kompass.rules.schema.conditions import Condition
from kompass.rules.schema.table import Table
from tests.backtest.event_logs import EPOCH_TIME, FLOAT, Shell
from tests.rules.building import absent, both, compare, received, rule
from tests.rules.strategies import GRID, callable_samples, samples, tables
from tests.support.properties import MANY, property_test

happenings = st.one_of(samples, samples, samples, callable_samples)
streams = st.lists(
    st.tuples(st.sampled_from((0, 1, 1, 2, 2, 3, 4, 8, 13)), happenings), max_size=30
)


def play(shell: Shell, stream: list[Any]) -> None:
    for gap, (topic, message) in stream:
        shell.say(topic, message, shell.now + gap * GRID)


def one_by_one(stream: list[Any]) -> list[Any]:
    """A stream as a monitor takes it, which never reads the same time twice."""
    return [(gap or 2**-13, happening) for gap, happening in stream]


@property_test(
    tables(),
    streams,
    st.lists(st.sampled_from((0.0, 0.0625, 0.3, 1.0)), min_size=1, max_size=3),
    st.sampled_from((0.0, 0.01)),
    many=MANY // 2,
)
def test_the_same_table_fires_the_same_at_the_same_times(
    table: Table, stream: list[Any], lengths: list[float], lag: float
) -> None:
    shell = Shell(table, tuple(lengths), lag)
    play(shell, stream)
    report = backtest(table, shell.log, shell.log)
    fired = [e for e in shell.log if isinstance(e, Fired)]
    assert (report.same, report.new, report.gone) == (len(fired), 0, 0)
    again = sorted((f.rule_id, f.at, f.leaves) for f in report.firings)
    assert again == sorted((f.rule_id, f.now, f.leaves) for f in fired)
    assert not any(firing.assumed for firing in report.firings)


@property_test(tables(), tables(), streams, streams, many=MANY // 2)
def test_what_else_was_applied_in_the_recording_makes_no_difference(
    before: Table, after: Table, first: list[Any], second: list[Any]
) -> None:
    """The proposed table is taken to be in force from the start to the end."""
    undisturbed, changed = Shell(after), Shell(before)
    for shell in (undisturbed, changed):
        play(shell, one_by_one(first))
        if shell is changed:
            shell.swap(after, shell.now)
        play(shell, one_by_one(second))
    report = backtest(after, changed.log, changed.log)
    again = [(f.rule_id, f.at) for f in report.firings if f.verdict != "gone"]
    fired = [(e.rule_id, e.now) for e in undisturbed.log if isinstance(e, Fired)]
    assert sorted(again) == sorted(fired)


def say(at: float, x: Any, topic: str = "a") -> Heard:
    return Heard(at, topic, FLOAT, SimpleNamespace(x=x))


def ramp() -> list[LoggedEvent]:
    """The field x of /a falls from 10 to 1 in steps of one, one a second, again and again."""
    return [say(float(n), 10 - n % 10) for n in range(100)]


def test_another_threshold_gives_exactly_the_firings_that_differ() -> None:
    strict, lax = (
        Table(rules=(rule(compare("a", "<", bound), trigger="edge", actions=(Log(text="!"),)),))
        for bound in (3, 5)
    )
    shell = Shell(strict)
    for event in ramp():
        assert isinstance(event, Heard)
        shell.say(event.topic, event.message, event.now)
    assert [f.at for f in shell.firings][:2] == [8.0, 18.0]
    report = backtest(lax, shell.log, shell.log)
    assert (report.same, report.new, report.gone) == (0, 10, 10)
    times = [(f.verdict, f.at) for f in report.firings[:2]]
    assert times == [("new", 6.0), ("gone", 8.0)]
    assert report.firings[0].time == EPOCH_TIME + 6.0
    assert report.firings[0].leaves[0].value == 4


def test_a_rule_that_is_removed_or_switched_off_says_so() -> None:
    one = rule(compare("a", "<", 3), "one", trigger="edge")
    shell = Shell(Table(rules=(one,)))
    for event in ramp()[:10]:
        assert isinstance(event, Heard)
        shell.say(event.topic, event.message, event.now)
    gone = backtest(Table(), shell.log, shell.log)
    assert [(f.verdict, f.text) for f in gone.firings] == [("gone", "the table has no such rule")]
    off = Table(rules=(one.model_copy(update={"enabled": False}),))
    report = backtest(off, shell.log, shell.log)
    assert [f.text for f in report.firings] == ["it is switched off"]
    (tally,) = report.tallies
    assert (tally.recorded, tally.proposed, tally.text) == (1, 0, "it is switched off")


@pytest.mark.parametrize(
    ("bound", "fields", "text"),
    [
        (1, {}, "false: a.x < 1"),
        (3, {"hold": 3.0}, "it has been true for 0.5 of 3 s"),
        (3, {"hold": 0.5, "cooldown": 25.0}, "it cools down for 15 s more"),
    ],
)
def test_a_firing_that_is_gone_says_what_would_have_held_it_back(
    bound: float, fields: dict[str, Any], text: str
) -> None:
    shell = Shell(Table(rules=(rule(compare("a", "<", 3), trigger="edge", hold=0.5),)))
    for event in ramp()[:20]:
        assert isinstance(event, Heard)
        shell.say(event.topic, event.message, event.now)
    proposed = rule(compare("a", "<", bound), trigger="edge", **fields)
    report = backtest(Table(rules=(proposed,)), shell.log, shell.log)
    assert [f.text for f in report.firings if f.verdict == "gone"][-1] == text


def test_a_run_that_did_not_happen_lasts_as_long_as_such_runs_did() -> None:
    """Runs take 4 s: with a cooldown of 3 s the rule is free again 7 s after it fires."""
    was = Table(rules=(rule(compare("a", "<", 3), cooldown=30.0),))
    shell = Shell(was, lengths=(4.0,))
    for event in ramp():
        assert isinstance(event, Heard)
        shell.say(event.topic, event.message, event.now)
    assert [f.at for f in shell.firings] == [8.0, 48.0, 88.0]
    report = backtest(
        Table(rules=(rule(compare("a", "<", 3), cooldown=3.0),)), shell.log, shell.log
    )
    found = [(f.at, f.verdict, f.assumed) for f in report.firings]
    assert found[:3] == [(8.0, "same", False), (18.0, "new", False), (28.0, "new", True)]
    assert report.gone == 0


def test_without_any_such_run_it_lasts_no_time() -> None:
    shell = Shell(Table())
    for event in ramp()[:20]:
        assert isinstance(event, Heard)
        shell.say(event.topic, event.message, event.now)
    report = backtest(Table(rules=(rule(compare("a", "<", 3)),)), shell.log, shell.log)
    assert [f.at for f in report.firings] == [8.0, 9.0, 18.0, 19.0]


def test_what_time_alone_brings_fires_between_two_messages() -> None:
    table = Table(rules=(rule(absent("a", 2.0), cooldown=1.0),))
    report = backtest(table, [say(0.0, 1), say(10.0, 1), say(10.5, 1, "b")])
    assert [f.at for f in report.firings] == [2.0]


@pytest.mark.parametrize(
    ("condition", "fields", "text"),
    [
        (compare("a", "<", 0), {}, "never true (a.x < 0: the lowest was 1)"),
        (compare("a", ">", 20), {}, "never true (a.x > 20: the highest was 10)"),
        (compare("b", "<", 1), {}, "the recording has nothing on b"),
        (both(compare("a", "<", 3), received("b")), {}, "never true (a.x < 3: the lowest was 1); "),
        (
            compare("a", "<", 3),
            {"hold": 2.5},
            "was true, but never so that it fires; it came close 9 times, last: was true for 2 of",
        ),
    ],
)
def test_a_rule_that_never_fires_says_why(
    condition: Condition, fields: dict[str, Any], text: str
) -> None:
    table = Table(rules=(rule(condition, **fields),))
    report = backtest(table, ramp())
    assert text in report.tallies[0].text


def test_topics_that_the_recording_lacks_are_named() -> None:
    table = Table(rules=(rule(both(compare("a", "<", 3), compare("b", "<", 3))),))
    report = backtest(table, ramp())
    assert report.missing_topics == ("b",)
    assert report.tallies[0].unknown_time == pytest.approx(20.0)


def test_a_message_of_another_type_is_not_heard() -> None:
    table = Table(rules=(rule(compare("a", "<", 3)),))
    log = [Heard(1.0, "/a", "std_msgs/msg/Int8", SimpleNamespace(x=0))]
    assert backtest(table, log).firings == ()


def test_a_recording_of_foreign_origin_counts_its_own_time_and_warms_up() -> None:
    table = Table(rules=(rule(compare("a", "<", 3), hold=1.0),))
    report = backtest(table, [say(1e9, 1), say(1e9 + 2, 5)])
    assert (report.start, report.end, report.messages) == (1e9, 1e9 + 2, 2)
    assert report.warm_up == 1.0
    assert [f.verdict for f in report.firings] == ["new"]


def test_a_file_that_goes_on_where_another_ended_changes_nothing() -> None:
    table = Table(rules=(rule(compare("a", "<", 3), trigger="edge"),))
    shell = Shell(table)
    for event in ramp():
        assert isinstance(event, Heard)
        shell.say(event.topic, event.message, event.now)
    middle = Resumed(55.0, EPOCH_TIME + 55.0, "life", 1, table)
    index = next(i for i, e in enumerate(shell.log) if e.now > 55.0)
    split = [*shell.log[:index], middle, *shell.log[index:]]
    assert backtest(table, split, split).firings == backtest(table, shell.log, shell.log).firings
    rest = split[index:]
    report = backtest(table, rest, rest)
    assert (report.same, report.new, report.gone) == (5, 0, 0)
    assert report.warm_up == 1.0


def test_a_difference_that_what_was_before_may_account_for_is_marked() -> None:
    """The rule cooled down when the recording began, and nobody knows."""
    table = Table(rules=(rule(compare("a", "<", 3), cooldown=15.0),))
    shell = Shell(table)
    for event in ramp():
        assert isinstance(event, Heard)
        shell.say(event.topic, event.message, event.now)
    assert [f.at for f in shell.firings] == [8.0, 28.0, 48.0, 68.0, 88.0]
    cut = [e for e in shell.log if e.now > 10.0]
    log = [Resumed(10.0, EPOCH_TIME + 10.0, "life", 1, table), *cut]
    report = backtest(table, log, log)
    found = [(f.at + 10.0, f.verdict, f.assumed) for f in report.firings]
    assert found[:2] == [(18.0, "new", True), (28.0, "gone", False)]
    assert report.warm_up == 15.0


def test_what_was_handled_before_the_recording_began_is_known_and_not_handled_again() -> None:
    clicked = received("a")
    whole = both(compare("a", ">", 3, timeout=None), compare("b", ">", 0))
    table = Table(rules=(rule(clicked, "clicked"), rule(whole, "both")))
    log: list[LoggedEvent] = [
        Resumed(10.0, EPOCH_TIME + 10.0, "life", 1, table),
        say(10.0, 5)._replace(again=True),
        say(12.0, 1, "b"),
        say(13.0, 4),
    ]
    report = backtest(table, log, log)
    assert [(f.rule_id, f.at) for f in report.firings][:2] == [("both", 2.0), ("clicked", 3.0)]


def test_rules_that_are_used_up_stay_so() -> None:
    table = Table(rules=(rule(compare("a", "<", 3), "r", once=True),))
    log: list[LoggedEvent] = [Began(0.0, 100.0, "life", 1, table, ("r",)), say(1.0, 1)]
    assert backtest(table, log, log).firings == ()


def test_a_rule_that_was_reset_on_request_begins_anew() -> None:
    table = Table(rules=(rule(compare("a", "<", 3), "r", once=True),))
    shell = Shell(table)
    shell.say("a", SimpleNamespace(x=1), 1.0)
    shell.swap(table, 2.0, reset=("r",))
    shell.say("a", SimpleNamespace(x=1), 3.0)
    assert len(shell.firings) == 2
    report = backtest(table, shell.log, shell.log)
    assert (report.same, report.new, report.gone) == (2, 0, 0)


def test_progress_is_told_and_may_cancel() -> None:
    told: list[float] = []
    log = [say(0.01 * n, 5) for n in range(10_000)]
    backtest(Table(), log, total=len(log), progress=told.append)
    assert told == sorted(told)
    assert (len(told) > 3, told[-1]) == (True, 1.0)

    def cancel(_: float) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        backtest(Table(), log, total=len(log), progress=cancel)


def test_more_firings_than_can_be_listed_are_counted() -> None:
    table = Table(rules=(rule(compare("a", "<", 100)),))
    report = backtest(table, ramp(), limit=7)
    assert (len(report.firings), report.new, report.truncated) == (7, 100, True)


def test_runs_of_the_recording_end_when_they_ended() -> None:
    table = Table(rules=(rule(compare("a", "<", 100)),))
    log: list[LoggedEvent] = [Began(0.0, 100.0, "life", 1, table)]
    log += [say(1.0, 1), Fired(1.0, "r", 1, 1.0, 1, "h"), say(2.0, 1), Ended(2.5, "r", 1)]
    log += [say(3.0, 1), Swapped(4.0, 2, table)]
    report = backtest(table, log, log)
    assert [(f.at, f.verdict) for f in report.firings] == [(1.0, "same"), (3.0, "new")]
