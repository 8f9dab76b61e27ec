"""Colours of the scene in both themes, as RGB 0..255.

Quiet greys for the building, one accent for where the robot is going; see the page's tokens.
"""

from __future__ import annotations

from dataclasses import dataclass

from kompass_console.schema.models import Theme

Rgb = tuple[int, int, int]


@dataclass(frozen=True, slots=True)
class Palette:
    """One theme's colours; `floor` is the colour behind everything, `extras` are of further topics,
    which share them."""

    floor: Rgb
    free: Rgb
    occupied: Rgb
    unknown: Rgb
    unknown_line: Rgb
    wall: Rgb
    obstacle: Rgb
    path: Rgb
    trail: Rgb
    scan: Rgb
    body: Rgb
    front: Rgb
    footprint: Rgb
    goal: Rgb
    preview: Rgb
    place: Rgb
    proposed: Rgb
    in_force: Rgb
    alert: Rgb
    extras: tuple[Rgb, ...]


_LIGHT = Palette(
    floor=(236, 238, 240),
    free=(250, 251, 252),
    occupied=(74, 82, 92),
    unknown=(222, 226, 230),
    unknown_line=(212, 217, 222),
    wall=(112, 121, 132),
    obstacle=(226, 122, 36),
    path=(28, 110, 220),
    trail=(120, 134, 150),
    scan=(10, 132, 130),
    body=(40, 48, 58),
    front=(255, 255, 255),
    footprint=(58, 66, 76),
    goal=(28, 110, 220),
    preview=(92, 150, 232),
    place=(84, 94, 108),
    proposed=(31, 95, 191),
    in_force=(176, 96, 0),
    alert=(147, 48, 95),
    extras=((112, 58, 178), (46, 125, 50), (150, 84, 24), (24, 96, 122), (168, 36, 122)),
)

_DARK = Palette(
    floor=(23, 27, 32),
    free=(43, 49, 57),
    occupied=(150, 160, 172),
    unknown=(30, 35, 41),
    unknown_line=(37, 43, 50),
    wall=(128, 138, 150),
    obstacle=(240, 156, 72),
    path=(96, 165, 250),
    trail=(112, 124, 140),
    scan=(72, 209, 204),
    body=(226, 231, 237),
    front=(20, 24, 29),
    footprint=(206, 213, 222),
    goal=(96, 165, 250),
    preview=(150, 196, 252),
    place=(176, 186, 200),
    proposed=(96, 165, 250),
    in_force=(236, 180, 79),
    alert=(238, 147, 191),
    extras=((190, 150, 250), (129, 199, 132), (224, 170, 110), (110, 196, 226), (240, 140, 208)),
)


def palette(theme: Theme) -> Palette:
    """The colours of a theme."""
    return _DARK if theme == "dark" else _LIGHT
