"""A clip of a recording that stands alone: what was valid at its beginning comes first."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from mcap.records import Channel

from kompass.backtest.event_log import Began
from kompass.recorder.engine_memory import EngineMemory
from kompass.recorder.mcap.reader import File, Recorded, Track, messages
from kompass.recorder.streams import EVENTS, LATCHED, REPEAT, event_json, read_event

_EVENTS = Track(
    topic=EVENTS.topic,
    type=EVENTS.schema[0],
    encoding=EVENTS.encoding,
    source=EVENTS.source,
    rule_topic=EVENTS.topic,
    schema=EVENTS.schema,
    channel=Channel(0, EVENTS.topic, EVENTS.encoding, {"source": EVENTS.source}, 0),
)


def is_event(track: Track) -> bool:
    """Whether a channel tells what the rule engine did."""
    return track.source == EVENTS.source


def clip_messages(
    files: Sequence[File],
    wanted: Callable[[Track], bool],
    start: int = 0,
    end: int | None = None,
) -> Iterator[Recorded]:
    """Yield the messages of one session of the stack between two times, in order.

    Where the clip begins in the middle, the table in force and the last message of each topic
    come first, as a file of the rotating
    recording begins with them. What later files repeat is left out.

    Parameters
    ----------
    start, end
        Nanoseconds, as in :func:`kompass.recorder.mcap.reader.messages`.

    Raises
    ------
    NotMcap
        When a file is damaged.
    """
    before = _Before()
    first: int | None = None
    relevant = [file for file in files if file.contents.loose or file.contents.end_time >= start]
    for message in messages(relevant, lambda track: is_event(track) or wanted(track), end=end):
        if message.log_time < start:
            before.take(message)
            continue
        if first is None:
            first = message.log_time
            yield from before.head(first)
        if not message.track.source.endswith(REPEAT) or message.log_time == first:
            yield message
    if first is None:
        yield from before.head(start)


class _Before:
    """What is known of the time before a clip."""

    def __init__(self) -> None:
        self._memory = EngineMemory()
        self._shift = 0  # from monotonic nanoseconds to those of the recording
        self._valid: dict[tuple[str, str], Recorded] = {}

    def take(self, message: Recorded) -> None:
        """Take note of a message."""
        source = message.track.source
        if source == EVENTS.source:
            found = read_event(message.data)
            self._memory.take(found.event)
            self._shift = message.log_time - found.now_ns
            if isinstance(found.event, Began):  # an engine that begins has heard nothing yet
                self._valid = {key: m for key, m in self._valid.items() if key[1] != "engine"}
        elif source != "tap" or LATCHED in message.track.channel.metadata:
            self._valid[message.track.topic, source.removesuffix(REPEAT)] = message

    def head(self, at: int) -> Iterator[Recorded]:
        """The table in force, and what was valid, as of ``at``."""
        now_ns = at - self._shift
        resumed = self._memory.resumed(now_ns * 1e-9)
        if resumed is not None:
            yield Recorded(at, at, 0, _EVENTS, event_json(resumed, now_ns))
        for message in self._valid.values():
            source = message.track.source.removesuffix(REPEAT) + REPEAT
            yield message._replace(log_time=at, track=message.track._replace(source=source))
