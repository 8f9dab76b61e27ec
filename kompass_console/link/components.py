"""Health of every component, as it says itself, and silence when it does not."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from automatika_ros_sugar.msg import ComponentStatus
from rclpy.node import Node

from kompass_console.link.graph.discovery import Graph, status_topics
from kompass_console.link.graph.reader import Reader
from kompass_console.schema.models import ComponentInfo, ComponentState, InputInfo, ProcessInfo
from kompass_console.schema.plain import LONGEST_LABEL, plain
from kompass_console.schema.world import Latest

SILENT_AFTER = 1.5  # s; components speak on change and at 5 Hz
_FORGET_AFTER = 600.0  # s of silence, when its topic has gone as well

_MOST_SOURCES = 50  # of whom one component complains

_STATES: dict[int, ComponentState] = {
    ComponentStatus.STATUS_HEALTHY: "healthy",
    ComponentStatus.STATUS_FAILURE_ALGORITHM_LEVEL: "algorithm_failure",
    ComponentStatus.STATUS_FAILURE_COMPONENT_LEVEL: "component_failure",
    ComponentStatus.STATUS_FAILURE_SYSTEM_LEVEL: "system_failure",
    ComponentStatus.STATUS_GENERAL_FAILURE: "general_failure",
}
_LABELS = {
    "planner": "Planner",
    "controller": "Controller",
    "mapper": "Local map",
    "local_mapper": "Local map",
    "drive_manager": "Drive",
    "driver": "Drive",
    "map_server": "Map",
    "motion_server": "Motion test",
    "simulator": "Simulator",
}


@dataclass(frozen=True, slots=True)
class Report:
    """One status message."""

    status: ComponentState
    message: str
    topics: tuple[str, ...]
    components: tuple[str, ...]
    algorithms: tuple[str, ...]


_NEVER = Report("silent", "", (), (), ())


def label_of(name: str) -> str:
    """The operator's word for a component."""
    own = name.rpartition("/")[2]
    return _LABELS.get(own, own.replace("_", " ").capitalize())


def report_of(message: Any) -> Report:
    """Status message as data; an unknown code counts as a general failure."""
    return Report(
        _STATES.get(int(message.status), "general_failure"),
        plain(message.msg),
        _names(message.src_topics),
        _names(message.src_components),
        _names(message.src_algorithms),
    )


def _names(said: Sequence[str]) -> tuple[str, ...]:
    return tuple(plain(name, LONGEST_LABEL) for name in said[:_MOST_SOURCES])


class Components:
    """All components whose status topic has been seen."""

    def __init__(self, node: Node, changed: Callable[[], None]) -> None:
        self._node = node
        self._changed = changed
        self._readers: dict[str, Reader[Report]] = {}
        self._reports: dict[str, Latest[Report]] = {}
        self._since = time.monotonic()

    @property
    def names(self) -> list[str]:
        """Components whose status topic has been seen, sorted."""
        return sorted(self._reports)

    def refresh(
        self, published: Graph, process_of: Callable[[str], ProcessInfo | None] = lambda _: None
    ) -> None:
        """Listen to new components; forget those that have been gone for long.

        Forget at once whose process is well and has no status: it is no component, and the
        monitor has only spoken for it (a simulator that did not get the processor for a while).
        """
        topics = status_topics(published)
        for name, topic in topics.items():
            if name not in self._readers:
                self._add(name)
            self._readers[name].follow(topic)
        for name in [n for n in self._readers if n not in topics]:
            process = process_of(name)
            well = process is not None and process.state == "active"
            if well or self._age(name) > _FORGET_AFTER:
                self._readers.pop(name).close()
                self._reports = {k: v for k, v in self._reports.items() if k != name}

    def infos(
        self,
        process_of: Callable[[str], ProcessInfo | None],
        inputs_of: Callable[[str], list[InputInfo]],
        outputs_of: Callable[[str], list[str]],
    ) -> list[ComponentInfo]:
        """State of every component, by name."""
        infos = []
        for name, latest in sorted(self._reports.items()):
            reader = self._readers.get(name)
            age = self._age(name)
            stamped = latest.get()
            silent = stamped is None or age > SILENT_AFTER
            report = _NEVER if stamped is None else stamped.value
            infos.append(
                ComponentInfo(
                    name=name,
                    label=label_of(name),
                    status="silent" if silent else report.status,
                    message=(
                        f"Nothing heard from it for {age:.0f} s." if silent else report.message
                    ),
                    sources=[*report.components, *report.topics, *report.algorithms],
                    src_topics=list(report.topics),
                    src_components=list(report.components),
                    src_algorithms=list(report.algorithms),
                    process=process_of(name),
                    inputs=inputs_of(name),
                    outputs=outputs_of(name),
                    age=age,
                    topic="" if reader is None else reader.topic or "",
                )
            )
        return infos

    def _add(self, name: str) -> None:
        latest: Latest[Report] = Latest()

        def store(report: Report) -> None:
            before = latest.get()
            latest.set(report)
            if before is None or before.value != report:
                self._changed()

        self._readers[name] = Reader(self._node, ComponentStatus, report_of, store, latched=True)
        self._reports = {**self._reports, name: latest}

    def _age(self, name: str) -> float:
        latest = self._reports.get(name)
        stamped = None if latest is None else latest.get()
        return time.monotonic() - self._since if stamped is None else stamped.age()
