"""One drive of a benchmark, measured."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, TypeAlias

from kompass.rules.schema.model import Model

MapKnown: TypeAlias = Literal["known", "walls", "none"]
BenchOutcome: TypeAlias = Literal["arrived", "contact", "too_late", "gave_up"]
# In words, the best first.
OUTCOMES: dict[BenchOutcome, str] = {
    "arrived": "arrived",
    "gave_up": "gave up",
    "too_late": "too late",
    "contact": "touched something",
}


class BenchDrive(Model):
    """One drive.

    Attributes
    ----------
    outcome
        ``arrived``: within 1 m of the goal in time, and nothing was touched in the whole drive.
        ``gave_up``: the planner ended the goal before that.
    reason
        In a sentence.
    time
        From setting out until within 1 m of the goal [s]; None when it never was.
    score
        By BARN's metric, 0 … 0.5.
    contacts
        Of the body with anything.
    clearance
        Least distance of the body to an obstacle [m], and ``clearance_at`` where the robot was.
    end_distance
        From the goal when the drive ended [m].
    driven, duration
        Metres and seconds in all.
    contact_places
        Where it touched something [m].
    track
        The way that was driven: (time, x, y), thinned.
    """

    world: str
    seed: int
    robot: str
    follower: str
    map: MapKnown
    outcome: BenchOutcome
    reason: str
    time: float | None
    score: float
    contacts: int
    clearance: float
    clearance_at: tuple[float, float]
    end_distance: float
    driven: float
    duration: float
    contact_places: tuple[tuple[float, float], ...] = ()
    track: tuple[tuple[float, float, float], ...] = ()

    @property
    def arrived(self) -> bool:
        """Whether it counts as a success."""
        return self.outcome == "arrived"


class BenchMeans(Model):
    """Of several drives.

    Attributes
    ----------
    arrived, exactly, touched
        How many of ``drives`` arrived, ended within 0.10 m of the goal without a contact, and
        touched something.
    score, time
        Means; of the time over those that arrived [s], None when none did.
    clearance
        The least of all [m].
    """

    drives: int
    arrived: int
    exactly: int
    touched: int
    score: float
    time: float | None
    clearance: float

    @property
    def sentence(self) -> str:
        """For people."""
        time = "" if self.time is None else f" in {self.time:.1f} s"
        return (
            f"{self.arrived} of {self.drives} arrived{time}, {self.exactly} of them to within "
            f"10 cm; {self.touched} touched something; least clearance {self.clearance:.3f} m; "
            f"score {self.score:.4f} of 0.5."
        )


def means(drives: Sequence[BenchDrive], there: float) -> BenchMeans:
    """What several drives come to; ``there`` is how near the goal is reached exactly [m]."""
    times = [drive.time for drive in drives if drive.arrived and drive.time is not None]
    exact = [not drive.contacts and drive.end_distance <= there for drive in drives]
    return BenchMeans(
        drives=len(drives),
        arrived=sum(drive.arrived for drive in drives),
        exactly=sum(exact),
        touched=sum(drive.outcome == "contact" for drive in drives),
        score=round(sum(drive.score for drive in drives) / max(1, len(drives)), 4),
        time=round(sum(times) / len(times), 2) if times else None,
        clearance=min((drive.clearance for drive in drives), default=0.0),
    )
