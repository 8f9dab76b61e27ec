"""A drill as one HTML file, which asks nobody for anything: no script, no font, no picture."""

from __future__ import annotations

import shlex
from collections.abc import Iterable, Iterator, Sequence
from html import escape

from kompass.drills.compare import Change, Comparison
from kompass.drills.drive import GRADES, OUTCOMES, DriveResult, FiringResult, Outcome
from kompass.drills.names import natural
from kompass.drills.report_json import Report, TableName
from kompass.drills.report_picture import (
    MARKS,
    drive_map,
    drive_timeline,
    has_alerts,
    world_symbols,
)
from kompass.drills.report_style import STYLE
from kompass.drills.summary import Summary

_SCENARIO = "SCENARIO.yaml"  # no path of a machine is in a report
PICTURED = 40  # drives that are shown with pictures
GLYPHS: dict[Outcome, str] = {
    "arrived": "●",
    "recovered": "●",
    "stood": "▲",
    "gave_up": "▲",
    "stopped": "■",
    "out_of_time": "○",
    "stood_silent": "○",
    "contact": "✖",
}
# How bad an outcome is, as a class of the style.
TONES = ("well", "careful", "unknown", "bad")
_CHANGES: dict[Change, str] = {"worse": "▼ worse", "better": "▲ better", "other": "◇ otherwise"}


def report_html(report: Report) -> str:
    """The page: the sentence that matters first, then numbers, then drives to look at."""
    name = escape(f"Drill of {report.recipe}: {report.sentence}")
    shown = _shown(report)
    worlds = [drive.scenario.world for _, _, drive in shown]
    body = "".join(
        (
            world_symbols(worlds),
            _head(report),
            _requirements(report),
            f'<div class="pair">{_numbers(report)}{_by_fault(report)}</div>',
            _pictured(report, shown),
            _all_drives(report),
            _again(report),
            _rules(report),
            _foot(report),
        )
    )
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta http-equiv="Content-Security-Policy" '
        "content=\"default-src 'none'; style-src 'unsafe-inline'\">\n"
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        '<meta name="color-scheme" content="light dark">\n'
        f"<title>{name}</title>\n<style>{STYLE}</style>\n</head>\n<body>\n{body}</body>\n</html>\n"
    )


# How it differs (HTML, empty where there is nothing to differ from), before, after.
_Shown = tuple[str, DriveResult | None, DriveResult]


def _shown(report: Report) -> list[_Shown]:
    """The drives to look at: those that differ, or without another table those that went badly."""
    if report.comparison is not None:
        before = {drive.scenario.name: drive for drive in report.drives_against}
        after = {drive.scenario.name: drive for drive in report.drives}
        return [
            (
                f'<span class="change {change.change}">{_CHANGES[change.change]}</span> '
                f"{escape(change.text)}",
                before[change.scenario],
                after[change.scenario],
            )
            for change in report.comparison.changes[:PICTURED]
        ]
    bad = [drive for drive in report.drives if not drive.came_through or drive.broken]
    bad.sort(key=lambda d: (-d.grade, -len(d.broken), natural(d.scenario.name)))
    return [("", None, drive) for drive in bad[:PICTURED]]


def _head(report: Report) -> str:
    found = report.comparison
    chance = f"<p>{escape(found.chance)}</p>" if found is not None and found.chance else ""
    tables = f"rules <b>{_table(report.table)}</b>"
    if report.against is not None:
        tables += f" against <b>{_table(report.against)}</b>"
    drives = _several(report.summary.drives, "drive")
    if report.against is not None:
        drives += " under each"
    seed = "" if report.seed is None else f", seed {report.seed}"
    on = f", driven by {escape(report.robots)}" if report.robots else ""
    notes = "".join(f'<p class="unknown">▲ {escape(note)}</p>' for note in report.notes)
    return (
        f'<header><p class="brand">◆ Kompass drill <span>{escape(report.recipe)}{on}</span></p>'
        f"{notes}<h1>{escape(report.sentence)}</h1>{_verdict(found)}{chance}"
        f'<p class="setup">{tables}; {drives}{seed}.</p></header>'
    )


def _verdict(found: Comparison | None) -> str:
    if found is None:
        return ""
    words = {
        "same": ("well", "● the same"),
        "better": ("well", "▲ better"),
        "worse": ("bad", "▼ worse"),
        "mixed": ("careful", "◆ better in some, worse in others"),
        "may be chance": ("unknown", "○ may be chance"),
    }
    tone, text = words[found.verdict]
    return f'<p class="verdict {tone}">{text}</p>'


def _table(table: TableName) -> str:
    return f"{escape(table.name)} ({_several(table.rules, 'rule')}, {escape(table.hash[:8])})"


def _requirements(report: Report) -> str:
    if not report.requirements:
        return ""
    items = "".join(
        f'<li class="{"well" if one.met else "bad"}">{"●" if one.met else "✖"} '
        f"{escape(one.text)}</li>"
        for one in report.requirements
    )
    return f'<section><h2>Required</h2><ul class="required">{items}</ul></section>'


def _numbers(report: Report) -> str:
    columns: list[tuple[str, Summary]] = []
    if report.against is not None and report.summary_against is not None:
        columns.append((report.against.name, report.summary_against))
    columns.append((report.table.name, report.summary))
    bars = "".join(_outcome_bar(name, summary) for name, summary in columns)
    rows = [
        (f"{GLYPHS[outcome]} {text}", [str(s.outcomes[outcome]) for _, s in columns])
        for outcome, text in OUTCOMES.items()
        if any(s.outcomes[outcome] for _, s in columns)
    ]
    rows += [
        ("drives that a fault disturbed", [str(s.disturbed) for _, s in columns]),
        ("drives with STOP at the end", [str(s.left_stopped) for _, s in columns]),
        ("contacts", [str(s.contacts) for _, s in columns]),
        ("invariants broken", [str(s.invariants_broken) for _, s in columns]),
        ("actions that failed", [str(s.actions_failed) for _, s in columns]),
        ("time to goal, median", [_seconds(s.time_to_goal_median) for _, s in columns]),
        ("recovery, median", [_seconds(s.recovery_median) for _, s in columns]),
        ("recovery, longest", [_seconds(s.recovery_max) for _, s in columns]),
    ]
    head = [escape(name) for name, _ in columns]
    return (
        f"<section><h2>What became of the drives</h2>{bars}"
        f"{_grid(['', *head], rows, numbers=True)}</section>"
    )


def _outcome_bar(name: str, summary: Summary) -> str:
    parts = "".join(
        f'<span class="part {TONES[GRADES[outcome]]}" style="flex-grow:{number}" '
        f'title="{number}: {OUTCOMES[outcome]}">{GLYPHS[outcome]} {number}</span>'
        for outcome in OUTCOMES
        if (number := summary.outcomes[outcome])
    )
    return (
        f'<div class="outcome"><span class="outcome-name">{escape(name)}</span>'
        f'<div class="parts">{parts}</div></div>'
    )


def _by_fault(report: Report) -> str:
    other = report.summary_against
    after = {tally.name: tally for tally in report.summary.faults}
    before = {tally.name: tally for tally in other.faults} if other else {}
    if not after and not before:
        return ""
    rows = []
    for name in sorted(after.keys() | before.keys()):
        found = [before.get(name), after.get(name)] if other else [after.get(name)]
        cells = [f"{one.came_through} of {one.drives}" if one else "–" for one in found]
        new = after.get(name)
        rows.append((escape(name), [*cells, _seconds(new.recovery_median if new else None)]))
    names = ["fault", escape(report.table.name), "recovery"]
    if report.against is not None:
        names.insert(1, escape(report.against.name))
    return (
        "<section><h2>By fault</h2><p>Of the drives in which it began, before the robot had "
        "arrived or stood for good, those that reached their goals and touched nothing; the "
        f"recovery is the median under {escape(report.table.name)}.</p>"
        f"{_grid(names, rows, numbers=True)}</section>"
    )


def _pictured(report: Report, shown: Sequence[_Shown]) -> str:
    if report.comparison is not None:
        total = len(report.comparison.changes)
        title, none = f"Drives that differ ({total})", "Every drive went as under the other table."
    else:
        total = sum(not drive.came_through or bool(drive.broken) for drive in report.drives)
        title, none = f"Drives to look at ({total})", "Every drive came through."
    if not shown:
        return f"<section><h2>{title}</h2><p>{none}</p></section>"
    more = (
        f"<p>{total - len(shown)} more are not drawn here; the JSON report has all.</p>"
        if total > len(shown)
        else ""
    )
    articles = "".join(_article(report, *one) for one in shown)
    return f"<section><h2>{title}</h2>{_legend()}{articles}{more}</section>"


def _legend() -> str:
    items = [("◁", "start", "start"), ("◎", "goal", "goal"), ("●", "end", "end of the drive")]
    items += [(glyph, kind, text) for kind, (glyph, text) in MARKS.items()]
    listed = "".join(
        f'<li><b class="point {kind}">{glyph}</b> {text}</li>' for glyph, kind, text in items
    )
    return f'<ul class="legend">{listed}</ul>'


def _article(report: Report, how: str, before: DriveResult | None, after: DriveResult) -> str:
    scenario = after.scenario
    faults = ", ".join(
        dict.fromkeys(f"{fault.name} at {fault.at:g} s" for fault in scenario.faults)
    )
    drives = [(report.table.name, after)]
    if before is not None and report.against is not None:
        drives.insert(0, (report.against.name, before))
    longest = max(drive.duration for _, drive in drives)
    alert = any(has_alerts(drive) for _, drive in drives)
    sides = [_side(name, drive, longest, alert=alert) for name, drive in drives]
    return (
        f"<article><h3>{escape(scenario.name)}</h3>{f'<p>{how}</p>' if how else ''}"
        f'<p class="scenario">{escape(scenario.world)}; {escape(faults) or "no fault"}</p>'
        f'<div class="sides">{"".join(sides)}</div></article>'
    )


def _side(name: str, drive: DriveResult, longest: float, *, alert: bool) -> str:
    broken = "".join(
        f'<li class="bad">✖ {one.at:.1f} s: {escape(one.text)} ({escape(one.invariant)})</li>'
        for one in drive.broken
    )
    return (
        f'<div class="side"><h4>{escape(name)}: {_outcome(drive)}</h4>'
        f"<p>{escape(drive.why)}</p>"
        f"{drive_map(drive, f'Map of {drive.scenario.name} under {name}')}"
        f"{drive_timeline(drive, longest, alert=alert)}"
        f"{f'<ul class=broken>{broken}</ul>' if broken else ''}"
        f"<details><summary>What happened, {_several(len(drive.moments), 'line')}</summary>"
        f"<ol>{''.join(_lines(drive))}</ol></details></div>"
    )


def _lines(drive: DriveResult) -> Iterator[str]:
    firings = {(firing.at, f"{firing.rule_id} fired"): firing for firing in drive.firings}
    for moment in drive.moments:
        firing = firings.get((moment.at, moment.text)) if moment.kind == "firing" else None
        did = "" if firing is None else f"<ul>{''.join(_did(firing))}</ul>"
        yield f"<li><time>{moment.at:.1f} s</time><span>{escape(moment.text)}</span>{did}</li>"


def _did(firing: FiringResult) -> Iterator[str]:
    if firing.text:
        yield f"<li>because {escape(firing.text)}</li>"
    for action in firing.actions:
        result = "done" if action.ok else "failed"
        text = f": {escape(action.text)}" if action.text else ""
        yield f"<li>{escape(action.action)} {result}{text}</li>"
    if firing.ok is None and not firing.shadow:
        yield "<li>nobody told what came of it</li>"


def _all_drives(report: Report) -> str:
    before = {drive.scenario.name: drive for drive in report.drives_against}
    rows = []
    for drive in report.drives:
        faults = ", ".join(dict.fromkeys(fault.name for fault in drive.scenario.faults))
        cells = [escape(drive.scenario.world), escape(faults)]
        if before:
            cells.append(_outcome(before[drive.scenario.name]))
        cells.append(_outcome(drive))
        rows.append((escape(drive.scenario.name), cells))
    names = ["drive", "world", "faults"]
    if report.against is not None and before:
        names.append(escape(report.against.name))
    names.append(escape(report.table.name))
    return (
        f"<section><details><summary>All drives ({len(rows)})</summary>{_grid(names, rows)}"
        "</details></section>"
    )


def _again(report: Report) -> str:
    """The command that makes a drive of this drill once more, to be looked at."""
    if not report.drives:
        return ""
    options = report.options
    words = ["kompass-console", "drill", "replay", report.drives[0].scenario.name]
    words += ["--recipe", report.recipe]
    if report.seed is not None:
        words += ["--seed", str(report.seed)]
    if options is None:
        words += ["--scenario", _SCENARIO]
    else:
        words += ["--worlds", ",".join(options.worlds), "--robot", options.robot]
        words += ["--faults", ",".join(options.faults)]
        if options.faults_per_drive != 1:
            words += ["--faults-per-drive", str(options.faults_per_drive)]
        if options.lasting:
            words += ["--lasting", f"{options.lasting:g}"]
    words += ["-o", f"{report.drives[0].scenario.name}.mcap"]
    told = ""
    if options is None:
        told = f", the file that it was read from for <code>{_SCENARIO}</code>"
    if report.table.name != "recipe":
        told += f" and with <code>--rules</code> and the file that has {_table(report.table)}"
    return (
        "<section><details><summary>One of the drives again</summary>"
        f"<p>With the name of the drive{told}:</p>"
        f"<p><code>{escape(shlex.join(words))}</code></p></details></section>"
    )


def _rules(report: Report) -> str:
    found = _fired(report.table, report.summary)
    if report.against is not None and report.summary_against is not None:
        found += _fired(report.against, report.summary_against)
    return found


def _fired(table: TableName, summary: Summary) -> str:
    rows = [
        (escape(tally.rule_id), [str(tally.firings), str(tally.drives), str(tally.failed)])
        for tally in summary.rules
    ]
    names = ["rule", "firings", "in drives", "failed"]
    told = _grid(names, rows, numbers=True) if rows else "<p>None.</p>"
    return f"<section><h2>Rules that fired, {escape(table.name)}</h2>{told}</section>"


def _foot(report: Report) -> str:
    return (
        "<footer><p>A drill tells what these rules make of these faults in a simulated robot. It "
        "does not tell what was never drawn: other faults, other places, other people. Chance here "
        "is that of drawing these scenarios; each of them alone goes the same way every time.</p>"
        f"<p>{escape(report.schema_version)}</p></footer>"
    )


def _outcome(drive: DriveResult) -> str:
    return (
        f'<span class="kind {TONES[drive.grade]}">{GLYPHS[drive.outcome]} '
        f"{OUTCOMES[drive.outcome]}</span>"
    )


def _grid(
    names: Sequence[str], rows: Iterable[tuple[str, Sequence[str]]], *, numbers: bool = False
) -> str:
    """A table of cells that are HTML already."""
    head = "".join(f'<th scope="col">{name}</th>' for name in names)
    body = "".join(
        f'<tr><th scope="row">{name}</th>{"".join(f"<td>{cell}</td>" for cell in cells)}</tr>'
        for name, cells in rows
    )
    kind = ' class="numbers"' if numbers else ""
    return (
        f'<div class="scroll"><table{kind}><thead><tr>{head}</tr></thead>'
        f"<tbody>{body}</tbody></table></div>"
    )


def _several(number: int, one: str) -> str:
    return f"{number} {one}" if number == 1 else f"{number} {one}s"


def _seconds(value: float | None) -> str:
    return "–" if value is None else f"{value:.1f} s"
