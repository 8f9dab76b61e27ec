"""What stands behind the colon of a fault's name: how much, which one of some, or which process.

A parameter is part of the name: ``scan_noise:0.05`` and ``scan_noise:0.1`` are two faults, which
may be on at once. It is never left out, so a number behind it is always a time.
"""

from __future__ import annotations

import difflib
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol


class FaultParameter(Protocol):
    """Reads what stands behind the colon."""

    @property
    def example(self) -> str:
        """One that can be read."""

    def read(self, text: str) -> str:
        """``text`` as it is always written; raises ValueError with what is wrong and allowed."""


@dataclass(frozen=True)
class Amount:
    """A number above 0.

    Attributes
    ----------
    unit
        What it counts, in words.
    most
        The largest that makes sense.
    example
        A usual one.
    """

    unit: str
    most: float
    example: str

    def read(self, text: str) -> str:
        allowed = f"give {self.unit}, above 0 and up to {self.most:g}"
        try:
            value = float(text)
        except ValueError:
            raise ValueError(f"{text!r} is no number; {allowed}") from None
        if not (math.isfinite(value) and 0.0 < value <= self.most):
            raise ValueError(f"{text} is out of range; {allowed}")
        return f"{value:.12g}"


@dataclass(frozen=True)
class Choice:
    """One word of some.

    Attributes
    ----------
    noun
        What is chosen.
    words
        Those that can be.
    """

    noun: str
    words: Sequence[str]

    @property
    def example(self) -> str:
        return self.words[0]

    def read(self, text: str) -> str:
        if text in self.words:
            return text
        near = difflib.get_close_matches(text, self.words, n=1, cutoff=0.4)
        hint = f"did you mean {near[0]!r}? " if near else ""
        raise ValueError(f"{text!r} is no {self.noun}; {hint}choose of {', '.join(self.words)}")


class Process:
    """A process of the stack or a node in it, which only the running stack knows."""

    example = "mapper"

    def read(self, text: str) -> str:
        try:
            float(text)
        except ValueError:
            return text
        raise ValueError(f"{text} names no process")


class Doorway:
    """A doorway of one of the worlds."""

    example = "kitchen"

    def read(self, text: str) -> str:
        # Loads NumPy, which a command line does without as long as nobody closes a door.
        from kompass.simulation.worlds.registry import world, world_names

        doors = [door.name for name in world_names() for door in world(name).doorways]
        return Choice("doorway of any world", doors).read(text)


WHEELS = ("left", "right", "both")
# A range of 0.3 m cannot be told from one of 3 m; a late reading of 10 s is no reading.
PARAMETERS: dict[str, FaultParameter] = {
    "wheel_slip": Choice("wheel", WHEELS),
    "localizer_jump": Amount("metres", 10.0, "0.5"),
    "localizer_drift": Amount("metres per metre driven", 1.0, "0.1"),
    "odometry_late": Amount("seconds", 10.0, "0.3"),
    "scan_late": Amount("seconds", 10.0, "0.3"),
    "scan_noise": Amount("metres (standard deviation)", 1.0, "0.05"),
    "glass": Amount("a share of the walls", 1.0, "0.3"),
    "mirrors": Amount("a share of the walls", 1.0, "0.3"),
    "door_closed": Doorway(),
    "stop": Process(),
    "kill": Process(),
    "starve": Process(),
    "hang": Process(),
    "flicker": Process(),
    "wrong": Process(),
    "network_late": Amount("seconds", 10.0, "0.1"),
    "network_loss": Amount("a share of the messages", 1.0, "0.3"),
}
