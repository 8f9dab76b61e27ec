"""Pictures of drives, as SVG inside of HTML: the map with the driven way, and the time line.

Every mark has a shape of its own, so that nothing is told by colour alone, and a title that says
what it is.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from html import escape

from kompass.drills.drive import DriveMoment, DriveResult
from kompass.simulation.worlds.registry import world
from kompass.simulation.worlds.shapes import Box, Shape
from kompass.simulation.worlds.world import World

_MARGIN = 0.15  # m around the outer wall
# What is marked on the map: by kind of moment, its shape and its name; what is graver comes later.
MARKS = {
    "fault": ("▲", "a fault began"),
    "firing": ("◆", "a rule fired"),
    "stop": ("■", "STOP"),
    "contact": ("✖", "touched something"),
}
_ALERTS = ("contact", "stop")


def world_symbols(names: Iterable[str]) -> str:
    """The floors of worlds, drawn once; maps show them by reference."""
    symbols = "".join(_symbol(world(name)) for name in dict.fromkeys(names))
    return f'<svg class="symbols" aria-hidden="true">{symbols}</svg>'


def drive_map(drive: DriveResult, label: str) -> str:
    """The world from above, x to the right and y up, with the driven way and what befell it."""
    place = world(drive.scenario.world)
    left, low, right, high = place.bounds
    left, low, right, high = left - _MARGIN, low - _MARGIN, right + _MARGIN, high + _MARGIN
    unit = max(right - left, high - low) / 44  # m; half of a mark
    view = f"{_n(left)} {_n(-high)} {_n(right - left)} {_n(high - low)}"
    parts = [f'<use href="#world-{escape(place.name)}"/>']
    parts += (_goal(goal.x, goal.y, number, unit) for number, goal in enumerate(drive.goals, 1))
    if drive.track:
        points = " ".join(f"{_n(x)},{_n(-y)}" for _, x, y in drive.track)
        parts.append(f'<polyline class="track-edge" points="{points}"/>')
        parts.append(f'<polyline class="track" points="{points}"/>')
        _, x, y = drive.track[-1]
        parts.append(
            f'<circle class="end" cx="{_n(x)}" cy="{_n(-y)}" r="{_n(0.55 * unit)}">'
            f"<title>Here the drive ended, after {drive.duration:.1f} s</title></circle>"
        )
    parts.append(_start(drive.scenario.first_pose, unit))
    parts += _marks(drive.moments, unit)
    return (
        f'<svg class="map" viewBox="{view}" role="img" aria-label="{escape(label, quote=True)}">'
        f"{''.join(parts)}</svg>"
    )


def has_alerts(drive: DriveResult) -> bool:
    """Whether something happened that has a row of its own on the time line."""
    return any(moment.kind in _ALERTS for moment in drive.moments)


def drive_timeline(drive: DriveResult, longest: float, *, alert: bool) -> str:
    """What was when, in rows; ``longest`` seconds fill the width.

    ``alert`` adds the row of what :func:`has_alerts` tells of, also to a drive without, so that
    two time lines side by side have the same rows.
    """
    ends = [
        (goal.sent, drive.duration if goal.ended is None else goal.ended) for goal in drive.goals
    ]
    faults = [
        (fault.began, drive.duration if fault.ended is None else fault.ended, fault.name)
        for fault in drive.faults
    ]
    rows = [
        _row("goal", _bars(((a, b, "under way") for a, b in ends), "goal", longest)),
        _row(
            "fault",
            _bars(faults, "fault", longest) + _points(drive.moments, ("fault",), longest),
        ),
        _row(
            "unwell",
            _bars(((s.begin, s.end, ", ".join(s.causes)) for s in drive.unwell), "unwell", longest),
        ),
        _row("rules", _points(drive.moments, ("firing",), longest)),
    ]
    if alert:
        rows.append(_row("alert", _points(drive.moments, _ALERTS, longest)))
    return f'<div class="timeline">{"".join(rows)}{_axis(longest)}</div>'


def _symbol(place: World) -> str:
    corners = " ".join(f"{_n(x)},{_n(-y)}" for x, y in place.floor)
    solids = "".join(map(_solid, place.solids))
    # Overflow: a symbol without a box of its own would clip what lies left of or above its origin.
    return (
        f'<symbol id="world-{escape(place.name)}" overflow="visible">'
        f'<polygon class="floor" points="{corners}"/>{solids}</symbol>'
    )


def _solid(shape: Shape) -> str:
    x, y = shape.center
    if not isinstance(shape, Box):
        return f'<circle class="solid" cx="{_n(x)}" cy="{_n(-y)}" r="{_n(shape.radius)}"/>'
    length, width = shape.size
    return (
        f'<rect class="solid" x="{_n(-length / 2)}" y="{_n(-width / 2)}" width="{_n(length)}" '
        f'height="{_n(width)}" transform="translate({_n(x)} {_n(-y)}) '
        f'rotate({_n(-math.degrees(shape.yaw))})"/>'
    )


def _start(pose: tuple[float, float, float], unit: float) -> str:
    x, y, yaw = pose
    tip = (
        f"{_n(1.3 * unit)},0 {_n(-0.8 * unit)},{_n(0.9 * unit)} {_n(-0.8 * unit)},{_n(-0.9 * unit)}"
    )
    return (
        f'<polygon class="start" points="{tip}" transform="translate({_n(x)} {_n(-y)}) '
        f'rotate({_n(-math.degrees(yaw))})"><title>Start</title></polygon>'
    )


def _goal(x: float, y: float, number: int, unit: float) -> str:
    where = f'cx="{_n(x)}" cy="{_n(-y)}"'
    return (
        f'<g class="goal"><circle {where} r="{_n(1.2 * unit)}"/>'
        f'<circle class="dot" {where} r="{_n(0.4 * unit)}"/>'
        f"<title>Goal {number} ({x:z.2f}, {y:z.2f})</title></g>"
    )


def _marks(moments: Iterable[DriveMoment], unit: float) -> Iterator[str]:
    """What befell the robot, where it did, the gravest first.

    Of a kind one mark stands for all at that place: the time line has each. Marks of other kinds
    stand in a row beside it, at the end of a line from where they belong.
    """
    placed: list[tuple[float, float]] = []
    for kind in reversed(MARKS):
        told: list[tuple[float, float]] = []
        for moment in moments:
            if moment.kind != kind or moment.x is None or moment.y is None:
                continue
            x, y = moment.x, moment.y
            if any(math.dist((x, y), other) < 1.9 * unit for other in told):
                continue
            told.append((x, y))
            while any(math.dist((x, y), other) < 1.9 * unit for other in placed):
                x += 2.0 * unit
            placed.append((x, y))
            if x > moment.x:
                yield (
                    f'<line class="leader" x1="{_n(moment.x)}" y1="{_n(-y)}" x2="{_n(x)}" '
                    f'y2="{_n(-y)}"/>'
                )
            yield _mark(moment, x, y, unit)


def _mark(moment: DriveMoment, x: float, y: float, r: float) -> str:
    shapes = {
        "fault": f"M 0 {_n(-r)} L {_n(0.95 * r)} {_n(0.75 * r)} L {_n(-0.95 * r)} {_n(0.75 * r)} Z",
        "firing": f"M 0 {_n(-r)} L {_n(0.8 * r)} 0 L 0 {_n(r)} L {_n(-0.8 * r)} 0 Z",
        "stop": f"M {_n(-r)} {_n(-r)} H {_n(r)} V {_n(r)} H {_n(-r)} Z",
        "contact": (f"M {_n(-r)} {_n(-r)} L {_n(r)} {_n(r)} M {_n(-r)} {_n(r)} L {_n(r)} {_n(-r)}"),
    }
    shape = shapes[moment.kind]
    # A cross has no inside that an edge could set off from what lies below.
    edge = f'<path class="cross-edge" d="{shape}"/>' if moment.kind == "contact" else ""
    return (
        f'<g transform="translate({_n(x)} {_n(-y)})">{edge}'
        f'<path class="mark {moment.kind}" d="{shape}"/>'
        f"<title>{moment.at:.1f} s: {escape(moment.text)}</title></g>"
    )


def _row(name: str, inside: str) -> str:
    return (
        f'<div class="row"><span class="row-name">{name}</span>'
        f'<div class="lane">{inside}</div></div>'
    )


def _bars(stretches: Iterable[tuple[float, float, str]], kind: str, longest: float) -> str:
    return "".join(
        f'<i class="bar {kind}" style="left:{_share(begin, longest)};'
        f'width:{_share(end - begin, longest)}" '
        f'title="{begin:.1f} s to {end:.1f} s: {escape(text, quote=True)}"></i>'
        for begin, end, text in stretches
    )


def _points(moments: Iterable[DriveMoment], kinds: tuple[str, ...], longest: float) -> str:
    return "".join(
        f'<b class="point {moment.kind}" style="left:{_share(moment.at, longest)}" '
        f'title="{moment.at:.1f} s: {escape(moment.text, quote=True)}">{MARKS[moment.kind][0]}</b>'
        for moment in moments
        if moment.kind in kinds
    )


def _axis(longest: float) -> str:
    ticks = "".join(
        f'<span style="left:{_share(at, longest)}">{at:g} s</span>' for at in _ticks(longest)
    )
    return (
        '<div class="row axis" aria-hidden="true"><span class="row-name"></span>'
        f'<div class="lane">{ticks}</div></div>'
    )


def _ticks(longest: float) -> Iterator[float]:
    """Round seconds, four or fewer of them, so that they have room on a phone."""
    step = next((s for s in (1, 2, 5, 10, 20, 30, 60, 120, 300, 600) if longest / s <= 4), 1200)
    at = 0
    while at <= longest * 0.97:
        yield float(at)
        at += step


def _share(value: float, whole: float) -> str:
    return f"{_n(100 * value / whole if whole else 0.0)}%"


def _n(value: float) -> str:
    return f"{value:.3f}".rstrip("0").rstrip(".")
