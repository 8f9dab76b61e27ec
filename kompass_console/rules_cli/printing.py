"""What the robot answers, for a person at a terminal."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterable, Mapping

from rich.console import Console
from rich.table import Table as TextTable
from rich.text import Text

from kompass.backtest.report import BacktestReport
from kompass.rulebook.schema.diff_models import TableDiff
from kompass.rulebook.schema.explanation import ExplanationView
from kompass.rulebook.schema.journal import FiringRecord, Journal
from kompass.rulebook.schema.report import ApplyReport, CheckReport, Conflict, Effect, Finding
from kompass.rulebook.schema.revision import History, Revision
from kompass.rulebook.schema.status import LeafReading, RuleStatus
from kompass.rulebook.schema.table_view import TableView
from kompass.rulebook.views.wording import seconds

PIPE_WIDTH = 200  # columns, where there is no terminal to ask
CHANGES = 5  # of a revision that its line in the history tells
# Never colour alone: a shape and a word go with it.
_STATES = {
    "ready": ("●", "green"),
    "holding": ("◐", "cyan"),
    "running": ("▶", "cyan"),
    "cooling": ("◔", "cyan"),
    "waiting": ("◌", "green"),
    "used up": ("◌", "green"),
    "latched": ("▲", "yellow"),
    "unknown": ("○", "yellow"),
    "disabled": ("–", "dim"),
    "shadow": ("◍", "magenta"),
    "broken": ("■", "red"),
}
# Of what a rule is to be expected: it fires by itself.
FIRES = ("soon", "with a message", "if silent")
_OUTCOMES = {"confirmed": "green", "active": "cyan", "taken back": "red", "superseded": "dim"}
_CHANGES = {"added": "green", "removed": "red", "changed": "yellow", "moved": "cyan"}
_VERDICTS = {True: ("true", "green"), False: ("false", "red"), None: ("unknown", "yellow")}
_MARKS = {"same": ("●", "dim"), "new": ("+", "green"), "gone": ("−", "red")}


def console(*, error: bool = False) -> Console:
    """Where to print; colours only on a terminal, and wide enough for whoever reads a pipe.

    What is printed is printed as it is: people write brackets and colons in reasons and names.
    """
    stream = sys.stderr if error else sys.stdout
    width = None if stream.isatty() else PIPE_WIDTH
    return Console(file=stream, width=width, highlight=False, markup=False, emoji=False)


def show_table(view: TableView, statuses: Mapping[str, RuleStatus]) -> None:
    """The rules, one a line, with how they are doing where that is known."""
    out = console()
    out.print(_headline(view))
    for line in view.notice.splitlines():
        out.print(_marked("▲", "yellow", line))
    if view.merge is not None:
        waiting = f"edits of revision {view.merge.revision} wait to be merged"
        out.print(_marked("▲", "yellow", f"{waiting} (rules export --merge)"))
        for line in view.merge.conflicts:
            out.print(f"    {line}")
    grid = TextTable(box=None, pad_edge=False, header_style="bold")
    for name in ("", "rule", "when", "then", "state", "fired", "last"):
        grid.add_column(name, overflow="fold", justify="right" if name == "fired" else "left")
    for rule in view.table.rules:
        status = statuses.get(rule.id)
        mark, colour = _STATES[status.state] if status else (" ", "dim")
        flags = " (protected)" if rule.protected else ""
        grid.add_row(
            Text(mark, colour),
            Text(rule.id + flags),
            Text(view.conditions.get(rule.id, "")),
            Text(", then ".join(view.actions.get(rule.id, ()))),
            Text(_state(status) if status else "enabled" if rule.enabled else "disabled", colour),
            str(status.fired) if status else "",
            _ago(status.last_fired) if status and status.last_fired else "",
        )
    out.print(grid)
    show_findings(view.findings)


def show_history(history: History) -> None:
    """Revisions, newest first."""
    grid = TextTable(box=None, pad_edge=False, header_style="bold")
    for name in ("rev", "", "outcome", "when", "who", "why", "what"):
        grid.add_column(name, overflow="fold")
    for revision in history.revisions:
        colour = _OUTCOMES[revision.outcome]
        in_force = "◀ in force" if revision.number == history.active else ""
        grid.add_row(
            str(revision.number),
            in_force,
            Text(_outcome(revision), colour),
            moment(revision.time),
            f"{revision.author} ({revision.role})",
            Text(revision.reason),
            Text("\n".join(_changes(revision))),
        )
    out = console()
    out.print(grid)
    if history.more:
        out.print(f"older ones: --before {history.revisions[-1].number}")


def show_diff(diff: TableDiff, *, title: str = "") -> None:
    """What differs, rule by rule."""
    out = console()
    if title:
        out.print(title, style="bold")
    if not diff.changes:
        out.print("  nothing differs")
    for change in diff.changes:
        mark = {"added": "+", "removed": "−", "changed": "~", "moved": "↕"}[change.kind]
        text = Text(f"  {mark} {change.rule_id}", _CHANGES[change.kind])
        text.append(f"  {change.summary}", "default" if change.semantic else "dim")
        out.print(text)


def show_findings(findings: Iterable[Finding], places: Iterable[str] | None = None) -> None:
    """Errors and lints; ``places`` are the same as lines that name a place in a file."""
    out = console()
    lines = list(places) if places is not None else [None] * len(tuple(findings))
    for finding, line in zip(findings, lines, strict=True):
        mark, colour = ("■ error", "red") if finding.level == "error" else ("▲ lint", "yellow")
        text = Text(f"{mark}  ", colour)
        text.append(line or _sentence(finding), "default")
        out.print(text)


def show_now(report: CheckReport) -> None:
    """What the rules would do as soon as they are applied: the first line of an answer."""
    if not report.now:
        return
    warn = any(each.acts and each.fires in FIRES for each in report.prospects)
    mark = Text("▲ ", "bold yellow") if warn else Text("● ", "dim")
    out = console()
    out.print(mark + Text(report.now, "bold" if warn else "default"))
    if warn:
        out.print("  this may stop or move the robot: try it in shadow first, or be ready for it")


def show_effect(effect: Effect, *, done: bool) -> None:
    """What happens, or has happened, to the state of the rules."""
    out = console()
    count = len(effect.carried)
    verb = ("was" if count == 1 else "were") if done else ("is" if count == 1 else "are")
    out.print(f"  {count} {'rule' if count == 1 else 'rules'} {verb} carried on unchanged")
    for ids, text in (
        (effect.reset, "start afresh"),
        (effect.added, "are new"),
        (effect.removed, "are removed"),
        (effect.running, "have actions running"),
    ):
        if ids:
            out.print(Text(f"  {', '.join(ids)}: {text}"))


def show_applied(report: ApplyReport) -> None:
    """A table went into force, and how to keep it or to go back."""
    out = console()
    said = (
        f"revision {report.revision} is in force (before: {report.previous}); "
        f"the engine paused for {report.pause * 1e3:.2f} ms"
    )
    out.print(_marked("●", "green", said))
    show_effect(report.effect, done=True)
    if report.probation:
        left = f"it is taken back in {seconds(report.probation)} unless it is confirmed:"
        out.print(_marked("▲", "yellow", left))
        out.print(f"  keep it:      kompass-console rules confirm {report.revision}")
        out.print("  take it back: kompass-console rules rollback")
    else:
        out.print("  it stays; to go back: kompass-console rules rollback")


def show_conflict(conflict: Conflict) -> None:
    """Somebody else was faster."""
    out = console()
    said = (
        f"revision {conflict.revision} ({conflict.author}, {moment(conflict.time)}: "
        f"{conflict.reason or 'no reason given'}) is in force; yours began from "
        f"{conflict.expected}. Nothing was applied."
    )
    out.print(_marked("■", "red", said))
    show_diff(conflict.theirs, title="what they changed")
    show_diff(conflict.yours, title="what you changed")
    if conflict.both:
        out.print(Text(f"both changed: {', '.join(conflict.both)}", "red"))
    out.print("to go on: export the revision in force, make your change in it, and apply again")


def show_explanation(view: ExplanationView, *, at: float | None = None) -> None:
    """Why a rule fires, or not; ``at`` is the second of a recording, None for now."""
    out = console()
    was = at is not None
    when = f"at {moment(view.time)}" if view.firing or was else "now"
    if at is not None:
        when = f"at {at:.1f} s, {moment(view.time)}"
    out.print(Text.assemble((view.rule_id, "bold"), f" {when} (revision {view.revision})"))
    out.print(Text(f"  {view.text}"))
    out.print(Text(f"  condition: {view.condition}"))
    _leaves(out, view.leaves, "was" if view.firing or was else "now")
    if view.clear_leaves:
        out.print("  fires again after:")
        _leaves(out, view.clear_leaves, "was" if was else "now")
    for gate in view.gates:
        out.print(Text(f"  ▲ {gate.text}", "yellow"))
    if view.firing is not None:
        _show_run(out, view.firing)
    if view.changed_since:
        out.print("  the rule has been changed since (rules history)")
    for miss in view.near_misses:
        out.print(Text(f"  near miss, {moment(miss.time)}: {miss.text}", "dim"))


def show_firings(journal: Journal) -> None:
    """Entries of the journal, newest first."""
    out = console()
    grid = TextTable(box=None, pad_edge=False, header_style="bold")
    for name in ("no", "when", "rule", "what", "rev", "run", "came of it"):
        grid.add_column(name, overflow="fold", justify="right" if name == "no" else "left")
    for entry in journal.firings:
        mark, colour = _result(entry)
        grid.add_row(
            str(entry.number),
            moment(entry.time),
            Text(entry.rule_id),
            entry.kind,
            str(entry.revision),
            str(entry.run_id or ""),
            Text(mark, colour) + Text(f" {entry.error or entry.text}", "default"),
        )
    out.print(grid)
    if not journal.firings:
        out.print("nothing has fired")
    if journal.more:
        out.print(f"older ones: --before {journal.firings[-1].number}")


def show_entry(entry: FiringRecord) -> None:
    """One entry of the journal, as a line of a log."""
    mark, colour = _result(entry)
    text = Text(f"{moment(entry.time)}  ", "dim")
    text.append(f"{mark:10}", colour)
    text.append(f"{entry.rule_id}  {entry.kind}, revision {entry.revision}", "default")
    said = entry.error or entry.text
    text.append(f": {said}" if said else "", "default")
    console().print(text)


def show_backtest(report: BacktestReport) -> None:
    """What a table would have done, beside what was done."""
    out = console()
    length = report.end - report.start
    out.print(
        f"{report.messages} messages over {seconds(length)}, {moment(report.start)} to "
        f"{moment(report.end)}, replayed in {seconds(report.seconds)}"
    )
    counts = (("same", f"{report.same} firings the same"), ("new", f"{report.new} new"))
    marked = [_marked(*_MARKS[verdict], f"{text}   ") for verdict, text in counts]
    out.print(Text.assemble(*marked, _marked(*_MARKS["gone"], f"{report.gone} gone")))
    for topic in report.missing_topics:
        out.print(Text(f"▲ the recording does not hold {topic}: not judged", "yellow"))
    for firing in report.firings:
        mark, colour = _MARKS[firing.verdict]
        text = Text(f"{mark} {firing.at:9.3f} s  {firing.rule_id}", colour)
        text.append(f"  {firing.text}{' (assumed)' if firing.assumed else ''}", "default")
        out.print(text)
    if report.truncated:
        out.print("… and more than are listed")
    for tally in report.tallies:
        if tally.proposed == 0 and tally.text:
            out.print(Text(f"  {tally.rule_id} never fires: {tally.text}", "dim"))


def moment(time_: float) -> str:
    """A time of day of this machine, with the date where it is not today."""
    at = time.localtime(time_)
    today = at[:3] == time.localtime()[:3]
    return time.strftime("%H:%M:%S" if today else "%Y-%m-%d %H:%M:%S", at)


# -- pieces ---------------------------------------------------------------------------------------


def _marked(shape: str, colour: str, text: str) -> Text:
    """A line that begins with a coloured shape."""
    return Text.assemble((shape, colour), f" {text}")


def _headline(view: TableView) -> Text:
    robot = (view.robot, "bold")
    if view.revision != view.active:
        return Text.assemble(robot, f" revision {view.revision} (in force: {view.active})")
    if view.probation_left:
        state = (f"▲ on probation, {seconds(view.probation_left)} left", "yellow")
    elif view.revision == view.confirmed:
        state = ("✓ confirmed", "green")
    else:
        state = ("not confirmed", "default")
    said = Text.assemble(robot, f" revision {view.revision}  ", state)
    return said.append("  ▲ safe mode", "yellow") if view.safe_mode else said


def _state(status: RuleStatus) -> str:
    return status.text or status.state


def _outcome(revision: Revision) -> str:
    marks = {"confirmed": "✓", "active": "▲", "taken back": "■", "superseded": "○"}
    word = "not confirmed yet" if revision.outcome == "active" else revision.outcome
    return f"{marks[revision.outcome]} {word}"


def _changes(revision: Revision) -> list[str]:
    changes = revision.diff.changes
    if revision.parent is None:
        return [f"{len(changes)} {'rule' if len(changes) == 1 else 'rules'}"]
    lines = [f"{change.rule_id}: {change.summary}" for change in changes[:CHANGES]]
    return [*lines, f"… and {len(changes) - CHANGES} more"] if len(changes) > CHANGES else lines


def _sentence(finding: Finding) -> str:
    rule = f"{finding.rule_id}: " if finding.rule_id else ""
    field = f"{finding.field}: " if finding.field else ""
    return f"{rule}{field}{finding.text}; {finding.remedy}"


def _leaves(out: Console, leaves: Iterable[LeafReading], tense: str) -> None:
    for leaf in leaves:
        word, colour = _VERDICTS[leaf.verdict]
        text = Text(f"  {'  ' * len(leaf.path)}{word:8}", colour)
        age = "never received" if leaf.age is None else f"{seconds(leaf.age)} old"
        text.append(f"{leaf.text}  ({tense} {_value(leaf)}, {age})", "default")
        out.print(text)


def _value(leaf: LeafReading) -> str:
    if isinstance(leaf.value, float):
        return f"{leaf.value:.4g}"
    return "nothing" if leaf.value is None else str(leaf.value)


def _show_run(out: Console, entry: FiringRecord) -> None:
    mark, colour = _result(entry)
    out.print(Text(f"  {mark} {entry.error}", colour))
    for action in entry.actions:
        sign, tone = ("●", "green") if action.ok else ("■", "red")
        out.print(Text(f"    {sign} {action.action}: {action.text} ({action.seconds:.2f} s)", tone))
    if entry.recording:
        out.print(Text(f"  recording: {entry.recording}"))


def _result(entry: FiringRecord) -> tuple[str, str]:
    if entry.kind == "firing" and entry.ended is None:
        return "▶ running", "cyan"
    if entry.ok is None:
        return "○", "dim"
    return ("● done", "green") if entry.ok else ("■ failed", "red")


def _ago(time_: float) -> str:
    return f"{seconds(time.time() - time_)} ago"
