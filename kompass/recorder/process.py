"""What the launcher needs: the recorder's process, and its other end in the monitor."""

from __future__ import annotations

import logging
import os
from collections.abc import Iterable, Mapping

from kompass.recorder.clip_policy import least_severity
from kompass.recorder.flight import FlightRecorder
from kompass.recorder.host import NAME, run_recorder
from kompass.recorder.places import recordings_folder
from kompass.recorder.shm_queue import ShmQueue
from kompass.recorder.topics import HasTopics, standard_topics
from kompass.store.errors import StoreUnwritable
from kompass.supervisor.process import ProcessSpec, Report

SETTING = "KOMPASS_RECORD"
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
    lane = ShmQueue()
    topics = standard_topics(components)

    def main(report: Report) -> None:
        run_recorder(lane, recordings, topics, report, namespace)

    return FlightRecorder(recordings, lane, least), [
        ProcessSpec(NAME, main, names=[NAME], allowed={NAME: SLOW_DISK})
    ]
