"""The flight recorder: what the engine took, and what the robot said, onto the disk."""

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
from kompass.recorder.places import rotation_folder
from kompass.recorder.rotating_recording import RotatingRecording, RotationBounds, rotation_files
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
CROWDED = 0.3  # part of the queue, beyond which it is not put off


class Recorder:
    """Takes frames from the queue and messages from the topic sampler; has no thread and no node.

    Parameters
    ----------
    queue
        From the monitor.
    recordings
        Folder of all recordings.
    resolve
        What a topic of the rules is called on the graph.
    leave_out
        Called with the topics (as on the graph) that the engine supplies.

    Raises
    ------
    RecordingInUse
        When another recorder writes there.
    OSError
        When it cannot be written.
    """

    def __init__(
        self,
        queue: ShmQueue,
        recordings: Path,
        resolve: Callable[[str], str],
        leave_out: Callable[[Collection[str]], object],
        bounds: RotationBounds = RotationBounds(),  # noqa: B008 - immutable
    ) -> None:
        self._queue, self._resolve, self._leave_out = queue, resolve, leave_out
        metadata = {"life": str(queue.session), "offset_ns": str(queue.offset_ns)}
        folder = rotation_folder(recordings)
        # Copying a clip must not hold up what comes from the queue.
        self._saver = ThreadPoolExecutor(1, thread_name_prefix="keep")
        self._clips = ClipKeeper(recordings, self._in_background)
        self._recording = RotatingRecording(folder, metadata, self._now, bounds, self._file_begins)
        self._memory = EngineMemory()
        self._streams: dict[tuple[str, str, str, bool], Stream] = {}
        self._sequence = queue.resume()
        self._flushed = time.monotonic()
        self._shift = 0
        self._compare_clocks()
        try:
            self._pick_up(folder)
        except BaseException:
            self._recording.close()
            raise

    @property
    def engine_topics(self) -> set[str]:
        """Topics (as on the graph) that the engine supplies."""
        return {self._resolve(name) for name in self._memory.topics}

    def _now(self) -> int:
        return time.monotonic_ns() + self._queue.offset_ns

    def tick(self) -> None:
        """Take what the engine took; bring it to disk when it is time."""
        self._compare_clocks()
        for frame in self._queue.read():
            self._take_frame(frame)
        now = time.monotonic()
        if now - self._flushed >= FLUSH_PERIOD or self._queue.fill > CROWDED:
            self.flush()
            self._clips.carry_out(self._now())

    def flush(self) -> None:
        """Bring all to disk. When that cannot be done, say so in the log and in the recording.

        Raises
        ------
        OSError
            When not even another file can be begun.
        """
        self._flushed = time.monotonic()
        try:
            self._recording.flush()
        except OSError as error:
            log.error("nothing is recorded now: %s", error)
            self._lost(self._now(), 0, f"could not be written: {error}")
        # What is on disk, or given up, makes room.
        self._queue.commit()

    def close(self) -> None:
        """Take what there is, and end the file properly."""
        try:
            self.tick()
            self.flush()
        finally:
            self._saver.shutdown(wait=False, cancel_futures=True)
            self._recording.close()

    def _in_background(self, job: Callable[[], None]) -> None:
        self._saver.submit(job).add_done_callback(_complain)

    def _compare_clocks(self) -> None:
        """The clock of the day may be set meanwhile; that of the recording must not leap."""
        before = time.monotonic_ns()
        wall = time.time_ns()
        after = time.monotonic_ns()
        if after - before < CLOSE_READINGS:
            self._shift = self._queue.offset_ns - (wall - (before + after) // 2)

    # -- what comes in ------------------------------------------------------------------------

    def take(self, taken: Taken) -> None:
        """A message that the recorder heard itself."""
        stream = self._stream(
            taken.name, taken.topic.type, "tap", taken.topic.name, latched=taken.latched
        )
        self._recording.write(
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
        at = frame.now_ns + self._queue.offset_ns
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
        self._recording.write(stream, at, frame.raw, frame.sequence, repeat=True)

    def _event(self, kind: str, data: dict[str, Any], at: int, sequence: int) -> None:
        if kind == KEEP:
            self._clips.order(ClipRequest(**data))
            return
        event = from_data(kind, data)
        self._write_event(event, at, sequence)
        self._memory.take(event)
        if isinstance(event, Began | Swapped):
            names = self.engine_topics
            self._leave_out(names)
            # An engine that begins has heard nothing yet.
            self._recording.keep_only("engine", names if isinstance(event, Swapped) else ())

    def _write_event(self, event: LoggedEvent, at: int, sequence: int = 0) -> None:
        data = event_json(event, at - self._queue.offset_ns)
        self._recording.write(EVENTS, at, data, sequence)

    def _lost(self, at: int, number: int, reason: str) -> None:
        self._write_event(Lost((at - self._queue.offset_ns) * 1e-9, number, reason), at)

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
        resumed = self._memory.resumed((at - self._queue.offset_ns) * 1e-9)
        if resumed is not None:
            self._write_event(resumed, at)

    def _pick_up(self, folder: Path) -> None:
        """Go on where an earlier recorder of the same stack was killed."""
        with Recording(rotation_files(folder)[-1:]) as recording:
            if not recording.files or recording.files[0].session != str(self._queue.session):
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
                    self._recording.remember(stream, message.data, message.publish_time)


def _complain(done: Future[None]) -> None:
    if not done.cancelled() and (error := done.exception()) is not None:
        log.error("a firing is not kept", exc_info=error)
