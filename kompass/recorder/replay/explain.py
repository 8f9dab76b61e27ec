"""Why a rule fired in a recording, or why not at some moment of it."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

from kompass.backtest.event_log import Began, Ended, Fired, LoggedEvent, Resumed, Swapped
from kompass.backtest.past import Past
from kompass.recorder.mcap.reader import Recording
from kompass.recorder.replay.backtest import NoRecording
from kompass.recorder.replay.beginning import beginning
from kompass.recorder.replay.replay import Replay
from kompass.rulebook.schema.explanation import ExplanationView
from kompass.rulebook.schema.journal import FiringRecord
from kompass.rulebook.views.views import explanation_view, firing_view
from kompass.rules.engine.compiled_table import compile_table
from kompass.rules.schema.table import Rule, Table

_ROUNDED = 0.1  # s by which whoever reads the end of a recording and asks for it may be beyond


class Explained(NamedTuple):
    """Why, and when that was: seconds since the beginning (:func:`beginning`)."""

    view: ExplanationView
    at: float


def explain_recorded(
    path: Path, rule_id: str, *, at: float | None = None, run: int = 0
) -> Explained:
    """Explain a rule at a moment of a recording, or one of its runs.

    Parameters
    ----------
    at
        Seconds since the beginning (:func:`beginning`); None for the end.
    run
        Number of a run of the rule, whose firing is explained instead; 0 for none.

    Raises
    ------
    NoRecording
        When the rule was not in force then, or there is no such run; the message says what there
        is.
    NotMcap
        When the file is damaged.
    """
    with Recording([path]) as recording:
        first, last = beginning(recording), recording.end_time
        if run:
            view = _fired(_events(recording), rule_id, run)
            return Explained(view, view.time - first * 1e-9)
        length = (last - first) * 1e-9
        if at is not None and at > length + _ROUNDED:
            raise NoRecording(
                f"at = {at:g} s is after its end, at {length:.1f} s; choose an earlier moment"
            )
        moment = last if at is None else min(first + round(at * 1e9), last)
        if moment <= recording.start_time:
            raise NoRecording(f"at = {at:g} s is before its beginning; choose a later moment")
        # What is asked for is the state just before the stretch from then to the end.
        replay = Replay(recording, compile_table(Table()), max((last - moment) * 1e-9, 1e-9))
        past: Past | None = None
        began: LoggedEvent | None = None
        table, revision = Table(), 0
        for event in replay.before():
            if isinstance(event, Began | Resumed):
                if past is None or isinstance(event, Began) or event.epoch != past.epoch:
                    past, began = Past(event), event
            elif past is not None:
                past.take(event)
            if isinstance(event, Began | Resumed | Swapped):
                table, revision = event.table, event.revision
    if past is None or not isinstance(began, Began | Resumed):
        raise NoRecording("no rules were in force then, as far as is recorded")
    compiled = compile_table(table)
    if rule_id not in compiled.by_id:
        raise NoRecording(_unknown(rule_id, compiled.by_id, "then"))
    offset = began.wall - began.now
    now = moment * 1e-9 - offset
    state = past.apply(compiled, now).state
    view = explanation_view(compiled, state, rule_id, now, offset, revision=revision)
    return Explained(view, (moment - first) * 1e-9)


def _events(recording: Recording) -> list[LoggedEvent]:
    return list(Replay(recording, compile_table(Table())).recorded())


def _unknown(rule_id: str, known: Iterable[str], when: str) -> str:
    names = sorted(known)
    near = difflib.get_close_matches(rule_id, names, n=1)
    hint = f"did you mean {near[0]!r}? " if near else ""
    told = ", ".join(names) or "none"
    return f"no rule {rule_id!r} was in force {when}; {hint}there were: {told}"


def _fired(events: list[LoggedEvent], rule_id: str, run: int) -> ExplanationView:
    rules: dict[str, Rule] = {}
    epoch, offset = "", 0.0
    found: tuple[Fired, Rule, str, float] | None = None
    ended: Ended | None = None
    runs: list[str] = []
    known: set[str] = set()
    for event in events:
        if isinstance(event, Began | Resumed):
            epoch, offset = event.epoch, event.wall - event.now
        if isinstance(event, Began | Resumed | Swapped):
            rules = {rule.id: rule for rule in event.table.rules}
            known |= rules.keys()
        elif isinstance(event, Fired) and event.rule_id == rule_id:
            runs.append(str(event.run_id))
            if event.run_id == run and found is None:
                found = event, rules[rule_id], epoch, offset
        elif isinstance(event, Ended) and (event.rule_id, event.run_id) == (rule_id, run):
            ended = ended or event
    if found is None and rule_id not in known:
        raise NoRecording(_unknown(rule_id, known, "in it"))
    if found is None:
        known_runs = f"its runs are {', '.join(runs)}" if runs else "it did not fire"
        raise NoRecording(f"the rule {rule_id!r} has no run {run} in it: {known_runs}")
    fired, rule, epoch, offset = found
    record = FiringRecord(
        number=0,
        epoch=epoch,
        run_id=run,
        rule_id=rule_id,
        name=rule.name,
        kind="shadow" if fired.shadow else "firing",
        time=fired.now + offset,
        revision=fired.revision,
        rule_hash=fired.rule_hash,
        severity=rule.severity.name.lower(),
        topic=fired.topic,
        leaves=fired.leaves,
        ended=None if ended is None else ended.now + offset,
        ok=None if ended is None else ended.ok,
        error="" if ended is None else ended.error,
    )
    return firing_view(record, rule, current=rule)
