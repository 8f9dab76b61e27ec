"""A benchmark as one HTML file, with a picture of every drive that failed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape

from kompass.bench.barn_file import BarnFile, BarnWorld
from kompass.bench.drive import OUTCOMES, BenchDrive, BenchOutcome, means
from kompass.bench.score import NEAR, THERE
from kompass.drills.report_style import STYLE
from kompass.simulation.physics.robot_model import robot_model
from kompass.simulation.worlds.shapes import Box

_GLYPHS: dict[BenchOutcome, str] = {
    "arrived": "●",
    "gave_up": "▲",
    "too_late": "○",
    "contact": "✖",
}
_TONES: dict[BenchOutcome, str] = {
    "arrived": "well",
    "gave_up": "careful",
    "too_late": "unknown",
    "contact": "bad",
}
_MARGIN = 0.15  # m around the outer wall
_STYLE = """
.optimal{fill:none;stroke:var(--well);stroke-width:2px;stroke-dasharray:6 5;
vector-effect:non-scaling-stroke}
.near{fill:none;stroke:var(--careful);stroke-width:1.5px;vector-effect:non-scaling-stroke}
.body{fill:none;stroke:var(--accent);stroke-width:1.5px;vector-effect:non-scaling-stroke}
.tight{stroke:var(--careful);stroke-width:2px;fill:none;vector-effect:non-scaling-stroke}
.touch{stroke:var(--bad);stroke-width:3px;vector-effect:non-scaling-stroke}
"""


def report_html(
    drives: Sequence[BenchDrive], worlds: Mapping[str, BarnWorld], file: BarnFile
) -> str:
    """The page: what it comes to, a picture of each drive that failed, and all in a table.

    Parameters
    ----------
    drives
        At least one.
    worlds
        By their names.
    file
        Start and goal.
    """
    found, first = means(drives, THERE), drives[0]
    failed = [drive for drive in drives if not drive.arrived]
    setup = f"{first.robot}, {first.follower}, map: {first.map}"
    pictures = "".join(_article(drive, worlds[drive.world], file) for drive in failed)
    rows = "".join(map(_row, drives))
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta http-equiv="Content-Security-Policy" '
        "content=\"default-src 'none'; style-src 'unsafe-inline'\">\n"
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        '<meta name="color-scheme" content="light dark">\n'
        f"<title>Benchmark of navigation: {escape(found.sentence)}</title>\n"
        f"<style>{STYLE}{_STYLE}</style>\n</head>\n<body>\n"
        f'<header><p class="brand">Kompass Console <span>benchmark of navigation</span></p>'
        f'<h1>{escape(found.sentence)}</h1><p class="setup">{escape(setup)}</p></header>'
        f"<section><h2>{len(failed)} of {len(drives)} drives failed</h2>{_LEGEND}{pictures}"
        "</section>"
        '<section><h2>All drives</h2><div class="scroll"><table class="numbers"><thead><tr>'
        "<th>world</th><th>seed</th><th>outcome</th><th>time [s]</th><th>score</th>"
        "<th>contacts</th><th>clearance [m]</th><th>from the goal [m]</th></tr></thead>"
        f"<tbody>{rows}</tbody></table></div></section>\n</body>\n</html>\n"
    )


_LEGEND = (
    '<p class="setup">Dashed: BARN\'s own path. Line: the way that was driven, with the body where '
    "it ended. Circle around the goal: near enough for BARN. Small ring: where the body came "
    "closest to something. ✖: where it touched something.</p>"
)


def _article(drive: BenchDrive, world: BarnWorld, file: BarnFile) -> str:
    label = f"{drive.world}, seed {drive.seed}"
    return (
        f"<article><h3>{_GLYPHS[drive.outcome]} {escape(label)}: {OUTCOMES[drive.outcome]}</h3>"
        f"<p>{escape(drive.reason)} It ended {drive.end_distance:.2f} m from the goal after "
        f"{drive.duration:.0f} s and {drive.driven:.1f} m; least clearance "
        f"{drive.clearance:.3f} m; {drive.contacts} contacts.</p>"
        f"{_picture(drive, world, file, label)}</article>"
    )


def _picture(drive: BenchDrive, world: BarnWorld, file: BarnFile, label: str) -> str:
    """From above, x to the right and y up."""
    place = world.place(file.start, file.goal)
    left, low, right, high = place.bounds
    left, low, right, high = left - _MARGIN, low - _MARGIN, right + _MARGIN, high + _MARGIN
    corners = _line(place.floor)
    parts = [f'<polygon class="floor" points="{corners}"/>']
    for shape in place.solids:
        x, y = shape.center
        if isinstance(shape, Box):
            length, width = shape.size
            parts.append(
                f'<rect class="solid" x="{-length / 2:.3f}" y="{-width / 2:.3f}" '
                f'width="{length:.3f}" height="{width:.3f}" '
                f'transform="translate({x:.3f} {-y:.3f}) rotate({-shape.yaw * 57.29578:.2f})"/>'
            )
        else:
            parts.append(_circle("solid", x, y, shape.radius))
    goal_x, goal_y = file.goal
    parts.append(_circle("near", goal_x, goal_y, NEAR))
    parts.append(f'<polyline class="optimal" points="{_line(world.path)}"/>')
    points = [(x, y) for _, x, y in drive.track]
    if points:
        parts.append(f'<polyline class="track-edge" points="{_line(points)}"/>')
        parts.append(f'<polyline class="track" points="{_line(points)}"/>')
        parts.append(_circle("body", *points[-1], robot_model(drive.robot).radius))
    parts.append(_circle("tight", *drive.clearance_at, 0.06))
    for x, y in drive.contact_places:
        parts.append(
            f'<path class="touch" d="M {x - 0.12:.3f} {-y - 0.12:.3f} l 0.24 0.24 '
            f'm 0 -0.24 l -0.24 0.24"/>'
        )
    view = f"{left:.3f} {-high:.3f} {right - left:.3f} {high - low:.3f}"
    return (
        f'<svg class="map" viewBox="{view}" role="img" aria-label="{escape(label, quote=True)}">'
        f"{''.join(parts)}</svg>"
    )


def _line(points: Sequence[tuple[float, float]]) -> str:
    return " ".join(f"{x:.3f},{-y:.3f}" for x, y in points)


def _circle(kind: str, x: float, y: float, radius: float) -> str:
    return f'<circle class="{kind}" cx="{x:.3f}" cy="{-y:.3f}" r="{radius:.3f}"/>'


def _row(drive: BenchDrive) -> str:
    time = "–" if drive.time is None else f"{drive.time:.1f}"
    tone, glyph = _TONES[drive.outcome], _GLYPHS[drive.outcome]
    return (
        f"<tr><th>{escape(drive.world)}</th><td>{drive.seed}</td>"
        f'<td><span class="{tone}">{glyph} {OUTCOMES[drive.outcome]}</span></td><td>{time}</td>'
        f"<td>{drive.score:.4f}</td><td>{drive.contacts}</td><td>{drive.clearance:.3f}</td>"
        f"<td>{drive.end_distance:.2f}</td></tr>"
    )
