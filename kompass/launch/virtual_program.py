"""A process of a stack in virtual time, over all its lives."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from kompass.supervisor.oversight import Life
from kompass.virtual.process import Thread, VirtualProcess

# Makes what runs in a process; returns who is told of the others, if it wants to be.
Main = Callable[[VirtualProcess], Callable[[str], object] | None]


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
        self.listener: Callable[[str], object] | None = None

    def executors(self, name: str) -> Sequence[Thread]:
        """Those of the process that lives: of one of its nodes, or all."""
        if self.process is None:
            return ()
        running = self.process.executors
        return [running[self.nodes.index(name)]] if name in self.nodes else running
