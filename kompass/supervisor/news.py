"""How a process is doing, as the supervisor tells those who listen: a JSON line each."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field
from typing import Literal

ProcessCondition = Literal["starting", "active", "busy", "stuck", "dead", "given up"]


@dataclass(frozen=True)
class ProcessNews:
    """What is told of one process, or of one node of a process that several share.

    Attributes
    ----------
    name
        Of the process; of the node where several share it.
    nodes
        ROS nodes meant.
    state
        What it is doing now.
    pid
        Of the process.
    restarts
        How often it was started again.
    reason
        In words; empty while there is nothing to say.
    stopped
        Whether a signal (SIGSTOP) holds it, which is known at once and called "busy" at first.
    born
        When the process began (clock ticks since boot): no other has both this and its pid.
    """

    name: str
    nodes: list[str] = field(default_factory=list)
    state: ProcessCondition = "starting"
    pid: int = 0
    restarts: int = 0
    reason: str = ""
    stopped: bool = False
    born: int = 0

    @property
    def is_lost(self) -> bool:
        """Whether it does nothing any more, for now or for good."""
        return self.stopped or self.state in ("stuck", "dead", "given up")

    def to_line(self) -> str:
        """One line, without its end."""
        return json.dumps(asdict(self))

    @classmethod
    def of_line(cls, line: str) -> ProcessNews:
        """As :meth:`to_line` wrote it."""
        return cls(**json.loads(line))
