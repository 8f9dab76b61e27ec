"""A drive in virtual time, written down as the flight recorder writes down a robot's."""

from __future__ import annotations

import json
import resource
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from kompass.access.gatekeeper import Gatekeeper
from kompass.backtest.event_log import Began, LoggedEvent, Swapped, from_data
from kompass.bus.node import Executor, Node
from kompass.drills.scenario import Scenario
from kompass.drills.scenario_file import scenario_text
from kompass.recorder.engine_memory import EngineMemory
from kompass.recorder.mcap.padding import without_padding
from kompass.recorder.mcap.writer import McapWriter
from kompass.recorder.replay.beginning import BEGAN, DRIVE
from kompass.recorder.streams import EVENTS, Stream, event_json, message_stream
from kompass.recorder.topics import SampledTopic
from kompass.rulebook.schema.journal import FiringRecord
from kompass.store.store import RuleStore
from kompass.virtual.network import Writer
from kompass.virtual.scheduler import Scheduler
from kompass.virtual.wire import Packet

CHUNK = 1 << 20  # bytes
SCENARIO = "scenario"  # in the metadata of the drive: what was to happen, as YAML


@contextmanager
def _disk_of_the_drill() -> Iterator[None]:
    """Who looks on can write, though the robot cannot: one process has room for both, and the
    robot's full disk is a limit of it."""
    room, most = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (most, most))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (room, most))


class NotInADrill(RuntimeError):
    """A drive is recorded from its beginning to its end, and nothing of it is kept apart."""


class DriveRecording:
    """A :class:`kompass.monitor.recording.FlightRecording` of a drive, and its event log.

    It takes no part in the drive: it sends nothing and is not on the network, so that a drive goes
    the same way with it and without.

    Parameters
    ----------
    path
        Must not exist yet.
    scheduler
        Whose time it is.
    topics
        To be written down besides what the rules look at.
    resolve
        What a topic is called on the network.

    Raises
    ------
    OSError
        When the file exists, or cannot be written.
    """

    def __init__(
        self,
        path: Path,
        scheduler: Scheduler,
        topics: Sequence[SampledTopic],
        resolve: Callable[[str], str],
    ) -> None:
        self._scheduler, self._resolve = scheduler, resolve
        self._offset = scheduler.wall - scheduler.now
        self._topics = {resolve(topic.name): topic for topic in topics}
        self._by_engine: set[str] = set()
        self._last: dict[str, int] = {}
        self._memory = EngineMemory()
        self._sequence = 0
        self._streams: dict[tuple[str, str, str, bool], Stream] = {}
        self._channels: dict[Stream, int] = {}
        self._writer = McapWriter(path)
        life = {"life": str(scheduler.wall), "offset_ns": str(self._offset), "saved": "1"}
        self._writer.add_metadata("kompass", life)

    def begins(self, scenario: Scenario) -> None:
        """Note that the drive begins now: from here on its times count."""
        began = str(self._scheduler.wall)
        with _disk_of_the_drill():
            self._writer.add_metadata(DRIVE, {BEGAN: began, SCENARIO: scenario_text(scenario)})

    def finish(self) -> None:
        """Bring the file to its end."""
        with _disk_of_the_drill():
            self._writer.finish()

    def abandon(self) -> None:
        """Close the file as it is."""
        self._writer.abandon()

    # -- on the network -----------------------------------------------------------------------

    def sent(self, writer: Writer, packet: Packet) -> None:
        """Take what somebody sends on a topic."""
        topic = self._topics.get(writer.name)
        if topic is None or writer.name in self._by_engine or writer.type_name != topic.type:
            return
        now = self._scheduler.now + writer.owner.sending_delay
        latched = writer.qos.latched
        last = self._last.get(writer.name)
        # A latched message is never left out: it may be the only one.
        if not latched and last is not None and now - last < topic.period * 1e9:
            return
        self._last[writer.name] = now
        stream = self._stream(writer.name, topic.type, "tap", topic.name, latched=latched)
        self._write(stream, now, without_padding(topic.type, packet.data))

    # -- what the engine takes ----------------------------------------------------------------

    def message(self, topic: str, type_name: str, raw: bytes, now_ns: int) -> None:
        """A message, serialised as it came (CDR)."""
        stream = self._stream(self._resolve(topic), type_name, "engine", topic)
        self._write(stream, now_ns, without_padding(type_name, raw))

    def event(self, kind: str, data: dict[str, Any], now_ns: int) -> None:
        """Anything else, as JSON data."""
        event = from_data(kind, data)
        self._write(EVENTS, now_ns, event_json(event, now_ns))
        self._follow(event)

    def text(self, kind: str, text: str, now_ns: int) -> None:
        """The same, for what is JSON text already."""
        self.event(kind, json.loads(text), now_ns)

    # -- for the monitor ----------------------------------------------------------------------

    @property
    def event_log(self) -> DriveRecording:
        """Takes what the engine takes."""
        return self

    def start(
        self, node: Node, executor: Executor, store: RuleStore | None, gatekeeper: Gatekeeper
    ) -> None:
        """Offer nothing: what is on the network would have a part in the drive."""

    def fired(self, entry: FiringRecord) -> None:
        """All of the drive is kept."""

    def save(self, seconds: float, name: str, until_ns: int) -> str:
        """Keep nothing apart.

        Raises
        ------
        NotInADrill
            Always.
        """
        raise NotInADrill("in a drill no stretch is kept: all of the drive is recorded, or nothing")

    def close(self) -> None:
        """A monitor may end before the drive does."""

    # -- on disk ------------------------------------------------------------------------------

    def _follow(self, event: LoggedEvent) -> None:
        self._memory.take(event)
        if isinstance(event, Began | Swapped):
            self._by_engine = {self._resolve(name) for name in self._memory.topics}

    def _stream(
        self, name: str, kind: str, source: str, rule_topic: str, *, latched: bool = False
    ) -> Stream:
        key = (name, kind, source, latched)
        found = self._streams.get(key)
        if found is None:
            found = message_stream(name, kind, source, rule_topic, latched=latched)
            self._streams[key] = found
        return found

    def _write(self, stream: Stream, now_ns: int, data: bytes) -> None:
        channel = self._channels.get(stream)
        if channel is None:
            metadata = {"source": stream.source, **dict(stream.metadata)}
            with _disk_of_the_drill():
                channel = self._writer.add_channel(
                    stream.topic, stream.encoding, stream.schema, metadata
                )
            self._channels[stream] = channel
        self._sequence += 1
        at = now_ns + self._offset
        self._writer.add_message(channel, at, data, at, self._sequence)
        if self._writer.pending >= CHUNK:
            with _disk_of_the_drill():
                self._writer.flush()
