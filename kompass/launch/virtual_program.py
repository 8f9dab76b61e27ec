"""A process of a stack in virtual time, over all its lives."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

from kompass.supervisor.oversight import Life
from kompass.virtual.process import Thread, VirtualProcess


class Ears(NamedTuple):
    """What a process takes from outside of ROS.

    Attributes
    ----------
    news
        How the other processes are doing, a JSON line each.
    packet
        What comes over its channel.
    """

    news: Callable[[str], object] | None = None
    packet: Callable[[bytes], object] | None = None


DEAF = Ears()
# Makes what runs in a process, of its life.
Main = Callable[[VirtualProcess, Life], Ears]


class Program:
    """A process of the stack, over all its lives.

    Attributes
    ----------
    name, nodes
        Of the process, and of the ROS nodes in it.
    main
        What runs in it.
    allowed
        How long a step of a node may take, by its name, where that is longer than usual [s].
    process, life
        The one that lives; None while none does.
    ears
        Of that one.
    """

    def __init__(
        self,
        name: str,
        nodes: Sequence[str],
        main: Main,
        allowed: Mapping[str, float] | None = None,
    ) -> None:
        self.name, self.nodes, self.main = name, list(nodes), main
        self.allowed = allowed or {}
        self.starts = 0
        self.process: VirtualProcess | None = None
        self.life: Life | None = None
        self.ears = DEAF

    def executors(self, name: str) -> Sequence[Thread]:
        """Those of the process that lives: of one of its nodes, or all."""
        if self.process is None:
            return ()
        running = self.process.executors
        return [running[self.nodes.index(name)]] if name in self.nodes else running
