"""The recorder's process: one thread that looks ten times a second at what has gathered."""

from __future__ import annotations

import gc
import logging
import os
import signal
import threading
from collections.abc import Sequence
from pathlib import Path

import rclpy
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

from kompass.recorder.recorder import Recorder
from kompass.recorder.rotating_recording import RecordingInUse
from kompass.recorder.shm_queue import ShmQueue
from kompass.recorder.topic_sampler import TopicSampler
from kompass.recorder.topics import SampledTopic
from kompass.supervisor.heartbeat import send_heartbeat
from kompass.supervisor.process import Report

NAME = "recorder"
PERIOD = 0.1  # s between looks
FIT_EVERY = 20  # looks, between looks at the publishers
RETRY = 10.0  # s after which a disk that could not be written is tried again
NICENESS = 10  # everything that drives the robot goes first

log = logging.getLogger("kompass.recorder")


def run_recorder(
    lane: ShmQueue,
    recordings: Path,
    topics: Sequence[SampledTopic],
    report: Report,
    namespace: str = "",
) -> None:
    """Record in this process until SIGTERM.

    A robot that cannot record drives all the same: what goes wrong is said, and tried again.

    Parameters
    ----------
    lane
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
                _record(lane, recordings, topics, node, ended)
            except (RecordingInUse, OSError) as error:
                if str(error) != said:
                    said = str(error)
                    log.error("nothing is recorded: %s", said)
                _idle(RETRY, ended)
    finally:
        node.destroy_node()
        rclpy.shutdown()


def _record(
    lane: ShmQueue,
    recordings: Path,
    topics: Sequence[SampledTopic],
    node: Node,
    ended: threading.Event,
) -> None:
    taps = TopicSampler(node, topics)
    recorder = Recorder(lane, recordings, node.resolve_topic_name, taps.leave_out)
    taps.leave_out(recorder.engine_topics)
    try:
        looks = 0
        while not ended.wait(PERIOD):
            send_heartbeat(NAME)
            recorder.tick()
            taps.drain(recorder.take)
            looks += 1
            if looks % FIT_EVERY == 0:
                taps.fit()
    finally:
        taps.drain(recorder.take)
        taps.close()
        recorder.close()


def _idle(seconds: float, ended: threading.Event) -> None:
    for _ in range(int(seconds / PERIOD)):
        if ended.wait(PERIOD):
            return
        send_heartbeat(NAME)
