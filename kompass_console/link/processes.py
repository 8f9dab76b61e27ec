"""The processes of the stack, as its supervisor sees them."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, get_args

from kompass_interfaces.msg import StackState
from rclpy.node import Node

from kompass_console.link.graph.discovery import Graph, of_type
from kompass_console.link.graph.reader import Reader
from kompass_console.schema.models import ProcessInfo, ProcessPhase
from kompass_console.schema.plain import LONGEST_LABEL, plain
from kompass_console.schema.world import Latest

_PHASES = frozenset(get_args(ProcessPhase))


@dataclass(frozen=True, slots=True)
class _Processes:
    all: tuple[ProcessInfo, ...]
    by_node: dict[str, ProcessInfo]


class Processes:
    """What the monitor passes on of the supervisor's view."""

    def __init__(self, node: Node, changed: Callable[[], None]) -> None:
        self._changed = changed
        self._newest: Latest[_Processes] = Latest()
        self._restarted: dict[str, float] = {}  # when each was (time.monotonic), as far as seen
        self._reader = Reader(node, StackState, _processes_of, self._store, latched=True)

    def refresh(self, published: Graph) -> None:
        """Listen to the monitor that is there now."""
        names = of_type(published, "kompass_interfaces/msg/StackState")
        self._reader.follow(names[0] if names else None)

    def infos(self) -> list[ProcessInfo]:
        """Every process, by name."""
        newest = self._newest.get()
        return [] if newest is None else [self._aged(info) for info in newest.value.all]

    def of(self, component: str) -> ProcessInfo | None:
        """The process that a component runs in; None where nobody supervises it."""
        newest = self._newest.get()
        if newest is None:
            return None
        info = newest.value.by_node.get(component.rpartition("/")[2])
        return None if info is None else self._aged(info)

    def _aged(self, info: ProcessInfo) -> ProcessInfo:
        at = self._restarted.get(info.name)
        return info if at is None else info.model_copy(update={"restarted": time.monotonic() - at})

    def _store(self, processes: _Processes) -> None:
        before = self._newest.get()
        if before is not None:
            self._restarted = self._restarted | {
                name: time.monotonic() for name in restarted(before.value.all, processes.all)
            }
        self._newest.set(processes)
        if before is None or before.value != processes:
            self._changed()


def restarted(before: Iterable[ProcessInfo], after: Iterable[ProcessInfo]) -> list[str]:
    """Names of those that were started again between two looks; a new stack counts anew."""
    counts = {info.name: info.restarts for info in before}
    return [info.name for info in after if info.restarts > counts.get(info.name, info.restarts)]


def _processes_of(message: Any) -> _Processes:
    infos = {p.name: _info_of(p) for p in message.processes}
    by_node = {
        str(node).rpartition("/")[2]: infos[process.name]
        for process in message.processes
        for node in process.nodes
    }
    return _Processes(tuple(info for _, info in sorted(infos.items())), by_node)


def _info_of(process: Any) -> ProcessInfo:
    return ProcessInfo(
        name=plain(process.name, LONGEST_LABEL),
        state=process.state if process.state in _PHASES else "unknown",
        pid=int(process.pid),
        restarts=int(process.restarts),
        reason=plain(process.reason),
        cpu=round(float(process.cpu), 3) if process.cpu >= 0.0 else None,
        memory=int(process.memory) or None,
    )
