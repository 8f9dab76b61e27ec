"""What many drives under one table come to, in numbers."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from statistics import median

from kompass.drills.drive import OUTCOMES, DriveResult
from kompass.rules.schema.model import Model


class FaultTally(Model):
    """Drives in which a fault began, by its name.

    Attributes
    ----------
    drives
        How many; ``disturbed`` those in which a fault (not always this one) disturbed the robot.
    came_through
        Those that reached their goals without touching anything.
    recovery_median
        Of what this fault itself disturbed and recovered [s]; None for never.
    """

    name: str
    drives: int
    disturbed: int
    came_through: int
    recovery_median: float | None = None


class RuleTally(Model):
    """Firings of a rule in all drives; ``failed`` those of which something went wrong."""

    rule_id: str
    firings: int
    drives: int
    failed: int


class Summary(Model):
    """Many drives under one table.

    Attributes
    ----------
    outcomes
        Number of drives by outcome, in the order of ``OUTCOMES``; their sum is ``drives``.
    disturbed
        Drives in which a fault made the robot unwell; ``recovered`` is counted among these.
    contacts
        Number of contacts, of which a drive may have several.
    left_stopped
        Drives at whose end STOP was in force, those that had arrived among them.
    time_to_goal_median, time_to_goal_max
        Seconds from sending to arriving, over the drives that came through; None for none.
    recovery_median, recovery_max
        Seconds, over the drives that recovered.
    """

    drives: int
    outcomes: dict[str, int]
    disturbed: int
    contacts: int
    invariants_broken: int
    actions_failed: int
    left_stopped: int
    time_to_goal_median: float | None = None
    time_to_goal_max: float | None = None
    recovery_median: float | None = None
    recovery_max: float | None = None
    faults: tuple[FaultTally, ...] = ()
    rules: tuple[RuleTally, ...] = ()

    @property
    def recovered(self) -> int:
        """Drives that a fault disturbed, and that reached their goals all the same."""
        return self.outcomes["recovered"]

    @property
    def came_through(self) -> int:
        """Drives that reached their goals without touching anything, disturbed or not."""
        return self.outcomes["arrived"] + self.outcomes["recovered"]


def summarize(drives: Sequence[DriveResult]) -> Summary:
    """Count drives. None of the numbers depends on their order."""
    outcomes = Counter(drive.outcome for drive in drives)
    times = sorted(t for drive in drives if (t := drive.time_to_goal) is not None)
    recoveries = sorted(
        drive.recovery
        for drive in drives
        if drive.outcome == "recovered" and drive.recovery is not None
    )
    return Summary(
        drives=len(drives),
        outcomes={outcome: outcomes[outcome] for outcome in OUTCOMES},
        disturbed=sum(drive.disturbed for drive in drives),
        contacts=sum(len(drive.contacts) for drive in drives),
        invariants_broken=sum(len(drive.broken) for drive in drives),
        actions_failed=sum(
            not action.ok
            for drive in drives
            for firing in drive.firings
            for action in firing.actions
        ),
        left_stopped=sum(drive.left_stopped for drive in drives),
        time_to_goal_median=middle(times),
        time_to_goal_max=times[-1] if times else None,
        recovery_median=middle(recoveries),
        recovery_max=recoveries[-1] if recoveries else None,
        faults=tuple(_faults(drives)),
        rules=tuple(_rules(drives)),
    )


def middle(values: Sequence[float]) -> float | None:
    """The median, to the millisecond; None of nothing."""
    return round(median(values), 3) if values else None


def _faults(drives: Iterable[DriveResult]) -> list[FaultTally]:
    by_name: dict[str, list[DriveResult]] = {}
    for drive in drives:
        for name in {fault.name for fault in drive.faults}:
            by_name.setdefault(name, []).append(drive)
    return [
        FaultTally(
            name=name,
            drives=len(found),
            disturbed=sum(drive.disturbed for drive in found),
            came_through=sum(drive.came_through for drive in found),
            recovery_median=middle(
                sorted(
                    fault.recovered_after
                    for drive in found
                    for fault in drive.faults
                    if fault.name == name and fault.recovered_after is not None
                )
            ),
        )
        for name, found in sorted(by_name.items())
    ]


def _rules(drives: Iterable[DriveResult]) -> list[RuleTally]:
    firings: Counter[str] = Counter()
    inside: Counter[str] = Counter()
    failed: Counter[str] = Counter()
    for drive in drives:
        inside.update({firing.rule_id for firing in drive.firings})
        firings.update(firing.rule_id for firing in drive.firings)
        failed.update(firing.rule_id for firing in drive.firings if firing.ok is False)
    return [
        RuleTally(rule_id=rule, firings=firings[rule], drives=inside[rule], failed=failed[rule])
        for rule in sorted(firings)
    ]
