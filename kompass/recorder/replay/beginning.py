"""From when on the times within a recording count."""

from __future__ import annotations

from kompass.recorder.mcap.reader import Recording

DRIVE = "kompass drive"  # metadata of the recording of a drive of a drill
BEGAN = "began"  # in it: when the drive began [ns of the recording]


def beginning(recording: Recording) -> int:
    """From when on times within a recording count [ns]: its first message, or its drive's start."""
    for file in recording.files:
        began = file.contents.metadata.get(DRIVE, {}).get(BEGAN)
        if began is not None:
            return int(began)
    return recording.start_time
