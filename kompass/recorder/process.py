"""The recorder's process, and what the launcher needs to run it.

One thread looks ten times a second at what has gathered.
"""

from __future__ import annotations

import contextlib
import gc
import logging
import os
import signal
import threading
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import rclpy
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

from kompass.recorder.clip_policy import least_severity
from kompass.recorder.flight import FlightRecorder
from kompass.recorder.places import recordings_folder
from kompass.recorder.recorder import Recorder
from kompass.recorder.rotating_recording import RecordingInUse
from kompass.recorder.shm_queue import ShmQueue
from kompass.recorder.topic_sampler import TopicSampler
from kompass.recorder.topics import HasTopics, SampledTopic, standard_topics
from kompass.store.errors import StoreUnwritable
from kompass.supervisor.heartbeat import send_heartbeat
from kompass.supervisor.process import ProcessSpec, Report

SETTING = "KOMPASS_RECORD"
NAME = "recorder"
PERIOD = 0.1  # s between looks
FIT_EVERY = 20  # looks, between looks at the publishers
RETRY = 10.0  # s after which a disk that could not be written is tried again
NICENESS = 10  # everything that drives the robot goes first
# s that the disk may take for a file that is finished; a card that is busy takes more than ten.
SLOW_DISK = 60.0

log = logging.getLogger("kompass.recorder")


def flight_recorder(
    components: Iterable[HasTopics],
    namespace: str = "",
    environment: Mapping[str, str] = os.environ,
) -> tuple[FlightRecorder | None, list[ProcessSpec]]:
    """The monitor's end of the flight recorder, and the processes to run for it.

    With ``KOMPASS_RECORD=0`` nothing is recorded, and there is no process; recordings that were
    kept can still be back-tested. Where there is no folder to record in there is no recorder at
    all, which is said: the robot drives all the same.

    Raises
    ------
    ValueError
        When KOMPASS_KEEP_FIRINGS names no severity.
    """
    least = least_severity(environment)
    try:
        recordings = recordings_folder(environment)
    except StoreUnwritable as error:
        log.error("nothing is recorded: %s", error)
        return None, []
    if environment.get(SETTING, "1").strip().lower() in ("0", "off", "false", "no"):
        return FlightRecorder(recordings, None, None), []
    queue = ShmQueue()
    topics = standard_topics(components)

    def main(report: Report) -> None:
        run_recorder(queue, recordings, topics, report, namespace)

    return FlightRecorder(recordings, queue, least), [
        ProcessSpec(NAME, main, names=[NAME], allowed={NAME: SLOW_DISK})
    ]


def run_recorder(
    queue: ShmQueue,
    recordings: Path,
    topics: Sequence[SampledTopic],
    report: Report,
    namespace: str = "",
) -> None:
    """Record in this process until SIGTERM.

    A robot that cannot record drives all the same: what goes wrong is said, and tried again.

    Parameters
    ----------
    queue
        From the monitor.
    recordings
        Folder of all recordings.
    topics
        To listen to besides.
    report
        Tells the supervisor.
    """
    ended = threading.Event()
    signal.signal(signal.SIGTERM, lambda *_: ended.set())
    os.nice(NICENESS)
    # A look of the collector at what came with the fork would copy all of it into this process.
    gc.freeze()
    rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    # In no executor: its readers are emptied by hand.
    node = rclpy.create_node(
        NAME,
        namespace=namespace or None,
        start_parameter_services=False,
        enable_rosout=False,
    )
    report(f"active {NAME}")
    try:
        said = ""
        while not ended.is_set():
            try:
                _record(queue, recordings, topics, node, ended)
            except (RecordingInUse, OSError) as error:
                if str(error) != said:
                    said = str(error)
                    log.error("nothing is recorded: %s", said)
                _idle(RETRY, ended)
    finally:
        node.destroy_node()
        rclpy.shutdown()


def _record(
    queue: ShmQueue,
    recordings: Path,
    topics: Sequence[SampledTopic],
    node: Node,
    ended: threading.Event,
) -> None:
    # One that cannot bring its last to disk lets go of all the same: the next one goes on there.
    with contextlib.ExitStack() as ends:
        sampler = TopicSampler(node, topics)
        ends.callback(sampler.close)
        recorder = Recorder(queue, recordings, node.resolve_topic_name, sampler.leave_out)
        ends.callback(recorder.close)
        ends.callback(sampler.drain, recorder.take)
        sampler.leave_out(recorder.engine_topics)
        looks = 0
        while not ended.wait(PERIOD):
            send_heartbeat(NAME)
            recorder.tick()
            sampler.drain(recorder.take)
            looks += 1
            if looks % FIT_EVERY == 0:
                sampler.fit()


def _idle(seconds: float, ended: threading.Event) -> None:
    for _ in range(int(seconds / PERIOD)):
        if ended.wait(PERIOD):
            return
        send_heartbeat(NAME)
