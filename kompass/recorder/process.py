"""What the launcher needs: the recorder's process, and its other end in the monitor."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping

from kompass.launch.process import ProcessSpec, Report
from kompass.recorder.flight import FlightRecorder
from kompass.recorder.host import NAME, run_recorder
from kompass.recorder.keeping import least_severity
from kompass.recorder.lane import Lane
from kompass.recorder.places import recordings_folder
from kompass.recorder.topics import HasTopics, standard_topics

SETTING = "KOMPASS_RECORD"


def flight_recorder(
    components: Iterable[HasTopics],
    namespace: str = "",
    environment: Mapping[str, str] = os.environ,
) -> tuple[FlightRecorder, list[ProcessSpec]]:
    """The monitor's end of the flight recorder, and the processes to run for it.

    With ``KOMPASS_RECORD=0`` nothing is recorded, and there is no process; recordings that were
    kept can still be back-tested.

    Raises
    ------
    ValueError
        When KOMPASS_KEEP_FIRINGS names no severity.
    StoreUnwritable
        When there is no folder to record in; see :func:`recordings_folder`.
    """
    least = least_severity(environment)
    recordings = recordings_folder(environment)
    if environment.get(SETTING, "1").strip().lower() in ("0", "off", "false", "no"):
        return FlightRecorder(recordings, None, None), []
    lane = Lane()
    topics = standard_topics(components)

    def main(report: Report) -> None:
        run_recorder(lane, recordings, topics, report, namespace)

    return FlightRecorder(recordings, lane, least), [ProcessSpec(NAME, main, names=[NAME])]
