"""From a recording to the events that the engine takes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from typing import Any

from rclpy.serialization import deserialize_message

from kompass.backtest.event_log import Began, Heard, LoggedEvent, Resumed, Swapped
from kompass.message_types import ros_class
from kompass.rclpy_ext.partial_decoder import Decode, Path, partial_decoder
from kompass.recorder.clip import clip_messages, is_event
from kompass.recorder.mcap.contents import NotMcap
from kompass.recorder.mcap.reader import File, Recorded, Recording, Track, messages, sessions_of
from kompass.recorder.streams import REPEAT, read_event
from kompass.rules.engine.compiled_table import CompiledTable, compile_table


class Replay:
    """A recording, or the end of one, for a table.

    What the engine heard itself is replayed as it heard it; topics that it did not listen to then
    are taken from what the recorder heard.

    Parameters
    ----------
    recording
        Open.
    table
        Only topics that it listens to are read.
    seconds
        How much of the end to replay; 0 for all of it.
    """

    def __init__(self, recording: Recording, table: CompiledTable, seconds: float = 0.0) -> None:
        self._table = table
        self._ears = _Ears([table])
        self._lives = sessions_of(recording.files)
        self._start = 0
        if seconds:
            self._start = recording.end_time - int(seconds * 1e9)

    @property
    def total(self) -> int:
        """Number of events, roughly, for a progress."""
        return sum(
            file.contents.counts.get(number, 0)
            for files in self._lives
            for file in files
            if file.contents.end_time >= self._start
            for number, track in file.tracks.items()
            if self._ears.want(track) or is_event(track)
        )

    @property
    def has_engine(self) -> bool:
        """Whether a rule engine was recorded too, to compare with."""
        return any(_has_engine(files) for files in self._lives)

    def before(self) -> Iterator[LoggedEvent]:
        """What the engine took before the stretch, in the session in whose middle that begins.

        With it a replay comes to know what the engine knew when the stretch began: all that its
        tables of then looked at is read. Nothing where the stretch begins with a session.

        Raises
        ------
        NotMcap
            When the recording is damaged.
        """
        for files in self._lives:
            if not self._start or not _has_engine(files):
                continue
            if any(file.contents.end_time >= self._start for file in files):
                yield from self._past(files)
                return  # what is later begins later

    def recorded(self) -> Iterator[LoggedEvent]:
        """What the engine did, without the messages that it heard."""
        for files in self._lives:
            for message in clip_messages(files, is_event, self._start):
                if is_event(message.track):
                    yield _read(message)[0]

    def events(self) -> Iterator[LoggedEvent]:
        """All that the engine is to be fed with, in order.

        Raises
        ------
        NotMcap
            When the recording is damaged.
        """
        for files in self._lives:
            yield from self._ours(files) if _has_engine(files) else self._others(files)

    def _past(self, files: list[File]) -> Iterator[LoggedEvent]:
        events = clip_messages(files, is_event, end=self._start)
        tables = [
            event.table
            for event, _ in (_read(message) for message in events if is_event(message.track))
            if isinstance(event, Began | Resumed | Swapped)
        ]
        # What the proposed table looks at is read, too: it begins with the newest values.
        ears = _Ears([self._table, *map(compile_table, tables)])

        def by_engine(track: Track) -> bool:
            return track.source.removesuffix(REPEAT) == "engine" and ears.want(track)

        shift: int | None = None
        for message in clip_messages(files, by_engine, end=self._start):
            track = message.track
            if is_event(track):
                event, now_ns = _read(message)
                shift = message.log_time - now_ns
                if not isinstance(event, Heard) or event.topic in ears.callables:
                    yield event
            elif shift is not None:
                heard = ears.heard(message, (message.log_time - shift) * 1e-9)
                yield heard._replace(again=track.source.endswith(REPEAT))

    def _ours(self, files: list[File]) -> Iterator[LoggedEvent]:
        shift: int | None = None  # from monotonic nanoseconds to those of the recording
        head: int | None = None  # time of the beginning, if that is in the middle of a life
        heard: frozenset[str] = frozenset()  # what the engine listened to
        for message in clip_messages(files, self._ears.want, self._start):
            track = message.track
            if is_event(track):
                event, now_ns = _read(message)
                if shift is None and isinstance(event, Resumed):
                    head = message.log_time
                if isinstance(event, Began | Swapped) or shift is None:
                    heard = _topics(event)
                shift = message.log_time - now_ns
                if not isinstance(event, Heard) or event.topic in self._ears.callables:
                    yield event
                continue
            if shift is None:
                continue  # from before the engine began
            source = track.source.removesuffix(REPEAT)
            if source != track.source and message.log_time != head:
                continue
            if source == "tap" and track.rule_topic in heard:
                continue
            taken = self._ears.heard(message, (message.log_time - shift) * 1e-9)
            # What the engine listens to only now, it would be given by a publisher that latches.
            again = source != track.source and source == "engine"
            yield taken._replace(again=again)

    def _others(self, files: list[File]) -> Iterator[LoggedEvent]:
        """A recording without an engine: from another tool, or of a stack without a monitor."""
        for message in messages(files, self._ears.want, self._start):
            if not message.track.source.endswith(REPEAT):
                yield self._ears.heard(message, message.log_time * 1e-9)


class _Ears:
    """What tables listen to, and how to read it."""

    def __init__(self, tables: Sequence[CompiledTable]) -> None:
        self.callables = frozenset(
            plan.name for table in tables for plan in table.topics if plan.callable
        )
        self._types: dict[str, set[str]] = {}
        self._paths: dict[str, list[Path]] = {}
        for table in tables:
            for name, kinds in table.topic_types().items():
                self._types.setdefault(name, set()).update(kinds)
            for name, paths in _paths(table).items():
                known = self._paths.setdefault(name, [])
                known += [path for path in paths if path not in known]
        self._classes: dict[str, type[Any] | None] = {}
        self._decoders: dict[tuple[str, str], Decode] = {}

    def want(self, track: Track) -> bool:
        """Whether one of the tables looks at a channel."""
        if track.encoding != "cdr" or track.type not in self._types.get(track.rule_topic, ()):
            return False
        return self._class(track.type) is not None

    def heard(self, message: Recorded, now: float) -> Heard:
        """A message as the engine takes it; ``now`` in its own seconds.

        Raises
        ------
        NotMcap
            When it is no message of its type.
        """
        track = message.track
        decode = self._decoder(track)
        try:
            content = decode(message.data)
        except Exception as error:
            raise NotMcap(f"a message on {track.topic} is no {track.type}: {error}") from error
        return Heard(now, track.rule_topic, track.type, content)

    def _decoder(self, track: Track) -> Decode:
        key = (track.rule_topic, track.type)
        found = self._decoders.get(key)
        if found is None:
            found = partial_decoder(track.type, self._paths.get(track.rule_topic, ()))
            if found is None:
                found = partial(deserialize_message, message_type=self._class(track.type))
            self._decoders[key] = found
        return found

    def _class(self, name: str) -> type[Any] | None:
        if name not in self._classes:
            try:
                self._classes[name] = ros_class(name)
            except ValueError:
                self._classes[name] = None
        return self._classes[name]


def _paths(table: CompiledTable) -> dict[str, list[Path]]:
    """What the rules read of the messages of each topic."""
    found: dict[str, list[Path]] = {}
    for leaf in table.leaves:
        signal = getattr(leaf.condition, "signal", None)
        if signal is not None and leaf.probe >= 0:
            found.setdefault(table.topics[leaf.topic].name, []).append(signal.path)
    return found


def _has_engine(files: list[File]) -> bool:
    return any(is_event(track) for file in files for track in file.tracks.values())


def _read(message: Recorded) -> tuple[LoggedEvent, int]:
    try:
        return read_event(message.data)
    except ValueError as error:
        raise NotMcap(f"the engine's channel is damaged: {error}") from error


def _topics(event: LoggedEvent) -> frozenset[str]:
    if not isinstance(event, Began | Resumed | Swapped):
        return frozenset()
    types = compile_table(event.table).topic_types()
    return frozenset(name for name, kinds in types.items() if kinds)
