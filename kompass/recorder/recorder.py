"""The flight recorder: what the engine took, and what the robot said, into the ring."""

from __future__ import annotations

import json
import logging
import time
from collections.abc import Callable, Collection
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any

from kompass.backtest.event_log import Began, LoggedEvent, Lost, Swapped, from_data
from kompass.recorder.clip_policy import KEEP, ClipKeeper, ClipRequest
from kompass.recorder.engine_memory import EngineMemory
from kompass.recorder.mcap.reader import Recording, messages
from kompass.recorder.places import ring_folder
from kompass.recorder.rotating_recording import Bounds, RotatingRecording, rotation_files
from kompass.recorder.shm_queue import Frame, ShmQueue
from kompass.recorder.streams import (
    EVENTS,
    LATCHED,
    REPEAT,
    Stream,
    event_json,
    message_stream,
    read_event,
)
from kompass.recorder.topic_sampler import Taken

log = logging.getLogger("kompass.recorder")

FLUSH_PERIOD = 1.0  # s, after which what was heard survives the death of everything
CLOSE_READINGS = 100_000  # ns between two readings that were not interrupted
CROWDED = 0.3  # part of the lane, beyond which it is not put off


class Recorder:
    """Takes frames from the lane and messages from the taps; has no thread and no node.

    Parameters
    ----------
    lane
        From the monitor.
    recordings
        Folder of all recordings.
    resolve
        What a topic of the rules is called on the graph.
    leave_out
        Called with the topics (as on the graph) that the engine supplies.

    Raises
    ------
    RingInUse
        When another recorder writes there.
    OSError
        When it cannot be written.
    """

    def __init__(
        self,
        lane: ShmQueue,
        recordings: Path,
        resolve: Callable[[str], str],
        leave_out: Callable[[Collection[str]], object],
        bounds: Bounds = Bounds(),  # noqa: B008 - immutable
    ) -> None:
        self._lane, self._resolve, self._leave_out = lane, resolve, leave_out
        metadata = {"life": str(lane.life), "offset_ns": str(lane.offset_ns)}
        folder = ring_folder(recordings)
        # Copying a stretch must not hold up what comes from the lane.
        self._saver = ThreadPoolExecutor(1, thread_name_prefix="keep")
        self._keeps = ClipKeeper(recordings, self._in_background)
        self._ring = RotatingRecording(folder, metadata, self._now, bounds, self._file_begins)
        self._memory = EngineMemory()
        self._streams: dict[tuple[str, str, str, bool], Stream] = {}
        self._sequence = lane.resume()
        self._flushed = time.monotonic()
        self._shift = 0
        self._compare_clocks()
        self._pick_up(folder)

    @property
    def engine_topics(self) -> set[str]:
        """Topics (as on the graph) that the engine supplies."""
        return {self._resolve(name) for name in self._memory.topics}

    def _now(self) -> int:
        return time.monotonic_ns() + self._lane.offset_ns

    def tick(self) -> None:
        """Take what the engine took; bring it to disk when it is time."""
        self._compare_clocks()
        for frame in self._lane.read():
            self._take_frame(frame)
        now = time.monotonic()
        if now - self._flushed >= FLUSH_PERIOD or self._lane.fill > CROWDED:
            self.flush()
            self._keeps.carry_out(self._now())

    def flush(self) -> None:
        """Bring all to disk. When that cannot be done, say so in the log and in the recording.

        Raises
        ------
        OSError
            When not even another file can be begun.
        """
        self._flushed = time.monotonic()
        try:
            self._ring.flush()
        except OSError as error:
            log.error("nothing is recorded now: %s", error)
            self._lost(self._now(), 0, f"could not be written: {error}")
        # What is on disk, or given up, makes room.
        self._lane.commit()

    def close(self) -> None:
        """Take what there is, and end the file properly."""
        try:
            self.tick()
            self.flush()
        finally:
            self._saver.shutdown(wait=False, cancel_futures=True)
            self._ring.close()

    def _in_background(self, job: Callable[[], None]) -> None:
        self._saver.submit(job).add_done_callback(_complain)

    def _compare_clocks(self) -> None:
        """The clock of the day may be set meanwhile; that of the recording must not leap."""
        before = time.monotonic_ns()
        wall = time.time_ns()
        after = time.monotonic_ns()
        if after - before < CLOSE_READINGS:
            self._shift = self._lane.offset_ns - (wall - (before + after) // 2)

    # -- what comes in ------------------------------------------------------------------------

    def take(self, taken: Taken) -> None:
        """A message that the recorder heard itself."""
        stream = self._stream(
            taken.name, taken.topic.type, "tap", taken.topic.name, latched=taken.latched
        )
        self._ring.write(
            stream,
            taken.received_ns + self._shift,
            taken.raw,
            publish_time=taken.sent_ns,
            repeat=taken.latched,
        )

    def _take_frame(self, frame: Frame) -> None:
        missing = frame.sequence - self._sequence - 1
        if missing < 0:
            return  # on disk already: a recorder died between writing it and saying so
        at = frame.now_ns + self._lane.offset_ns
        if missing and self._sequence:
            self._lost(at, missing, "the recorder did not keep up")
        self._sequence = frame.sequence
        if frame.is_event:
            try:
                self._event(frame.topic, json.loads(frame.raw), at, frame.sequence)
            except (ValueError, TypeError) as error:
                log.error("an event of the engine is not recorded: %s", error)
                self._lost(at, 1, "an event could not be understood")
            return
        stream = self._stream(self._resolve(frame.topic), frame.type, "engine", frame.topic)
        self._ring.write(stream, at, frame.raw, frame.sequence, repeat=True)

    def _event(self, kind: str, data: dict[str, Any], at: int, sequence: int) -> None:
        if kind == KEEP:
            self._keeps.order(ClipRequest(**data))
            return
        event = from_data(kind, data)
        self._write_event(event, at, sequence)
        self._memory.take(event)
        if isinstance(event, Began | Swapped):
            names = self.engine_topics
            self._leave_out(names)
            # An engine that begins has heard nothing yet.
            self._ring.keep_only("engine", names if isinstance(event, Swapped) else ())

    def _write_event(self, event: LoggedEvent, at: int, sequence: int = 0) -> None:
        data = event_json(event, at - self._lane.offset_ns)
        self._ring.write(EVENTS, at, data, sequence)

    def _lost(self, at: int, number: int, reason: str) -> None:
        self._write_event(Lost((at - self._lane.offset_ns) * 1e-9, number, reason), at)

    def _stream(
        self, name: str, kind: str, source: str, rule_topic: str, *, latched: bool = False
    ) -> Stream:
        key = (name, kind, source, latched)
        found = self._streams.get(key)
        if found is None:
            found = message_stream(name, kind, source, rule_topic, latched=latched)
            self._streams[key] = found
        return found

    # -- files that stand alone ---------------------------------------------------------------

    def _file_begins(self, at: int) -> None:
        """Say in a new file which table is in force."""
        resumed = self._memory.resumed((at - self._lane.offset_ns) * 1e-9)
        if resumed is not None:
            self._write_event(resumed, at)

    def _pick_up(self, folder: Path) -> None:
        """Go on where an earlier recorder of the same stack was killed."""
        with Recording(rotation_files(folder)[-1:]) as recording:
            if not recording.files or recording.files[0].life != str(self._lane.life):
                return
            for message in messages(recording.files, lambda track: bool(track.source)):
                track = message.track
                self._sequence = max(self._sequence, message.sequence)
                if track.source == EVENTS.source:
                    self._memory.take(read_event(message.data).event)
                elif track.source != "tap" or LATCHED in track.channel.metadata:
                    stream = self._stream(
                        track.topic,
                        track.type,
                        track.source.removesuffix(REPEAT),
                        track.rule_topic,
                        latched=LATCHED in track.channel.metadata,
                    )
                    self._ring.remember(stream, message.data, message.publish_time)


def _complain(done: Future[None]) -> None:
    if not done.cancelled() and (error := done.exception()) is not None:
        log.error("a firing is not kept", exc_info=error)
