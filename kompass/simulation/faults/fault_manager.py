"""Which faults are on, and when they begin and end. It has no clock: callers pass ``now``."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from typing import Protocol

from kompass.simulation.faults.fault_names import (
    FaultOrder,
    check_fault,
    is_of_machine,
    only_in_drills,
)


class FaultRefused(RuntimeError):
    """A fault cannot be switched on or off; the message says why, and what would help."""


class NotYet(FaultRefused):
    """It cannot be switched on now, but may be later: its target has not shown up."""


class FaultKind(Protocol):
    """Faults of one kind: of the robot, of processes, of the map."""

    def knows(self, name: str) -> bool:
        """Whether ``name`` is one of them."""

    def begin(self, name: str) -> bool:
        """Switch it on; False when it is over at once, as a kill is."""

    def end(self, name: str) -> None:
        """Switch it off."""

    def ended(self) -> Iterable[str]:
        """Faults that have come to an end by themselves."""


class FaultManager:
    """Switches faults of every kind on and off, at once or when their time comes.

    Parameters
    ----------
    kinds
        Asked in turn who knows a fault.
    orders
        Faults to begin by themselves.
    now
        Monotonic seconds; what the orders' times count from.
    changed
        Called with the faults that are on, whenever they have changed.
    """

    def __init__(
        self,
        kinds: Sequence[FaultKind],
        orders: Iterable[FaultOrder],
        now: float,
        changed: Callable[[tuple[str, ...]], None],
    ) -> None:
        self._kinds = kinds
        self._due = [(now + order.after, order) for order in orders]
        self._ends: dict[str, float] = {}
        self._changed = changed

    @property
    def active(self) -> tuple[str, ...]:
        """Faults that are on, in the order in which they came."""
        return tuple(self._ends)

    def switch(self, name: str, on: bool, duration: float, now: float) -> None:
        """Switch a fault on or off.

        Parameters
        ----------
        name
            Of the fault.
        on
            Which of the two.
        duration
            Seconds after which it ends by itself; 0 for never.
        now
            Monotonic seconds.

        Raises
        ------
        UnknownFault
            There is no such fault.
        FaultRefused
            It cannot be switched.
        """
        name = check_fault(name)
        kind = self._kind(name)
        if not (math.isfinite(duration) and duration >= 0.0):
            raise FaultRefused(
                f"duration is {duration!r} s; give a time of 0 or more, 0 for no end"
            )
        if on:
            if name in self._ends or kind.begin(name):
                self._ends[name] = now + duration if duration else math.inf
        elif name in self._ends:
            kind.end(name)
            del self._ends[name]
        self._changed(self.active)

    def advance(self, now: float) -> None:
        """Begin and end what is due at ``now`` (monotonic seconds)."""
        for due in [due for due in self._due if due[0] <= now]:
            self._due.remove(due)
            order = due[1]
            try:
                self.switch(order.name, True, order.duration, now)
            except NotYet:
                self._due.append(due)  # its target is on its way up; the next call tries again
        ended = [name for kind in self._kinds for name in kind.ended() if name in self._ends]
        for name in ended:
            del self._ends[name]
        for name in [name for name, end in self._ends.items() if end <= now]:
            self.switch(name, False, 0.0, now)
        if ended:
            self._changed(self.active)

    def close(self) -> None:
        """End all faults, so that none outlasts the simulator."""
        for name in self.active:
            self._kind(name).end(name)
        self._ends.clear()

    def _kind(self, name: str) -> FaultKind:
        for kind in self._kinds:
            if kind.knows(name):
                return kind
        if is_of_machine(name):
            raise FaultRefused(only_in_drills(name))
        raise FaultRefused(f"fault {name!r} is of no use here")
