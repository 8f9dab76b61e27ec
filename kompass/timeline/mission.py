"""What becomes of missions, as happenings."""

from __future__ import annotations

from kompass.missions.run import Run
from kompass.timeline.entry import Level
from kompass.timeline.happening import Began, Happened, Happening, Over

_ENDED: dict[str, tuple[str, Level]] = {
    "done": ("Done", "info"),
    "failed": ("Failed", "error"),
    "canceled": ("Cancelled", "info"),
}


class MissionObserver:
    """Follows the run of now."""

    def __init__(self) -> None:
        self._told: tuple[int, int, str] | None = None

    def sees(self, run: Run | None, now: float) -> list[Happening]:
        """The run as it is; ``now`` in seconds since the epoch."""
        if run is None or self._told == (run.number, run.step, run.phase):
            return []
        first = self._told is None or self._told[0] != run.number
        self._told = run.number, run.step, run.phase
        key, name = f"mission {run.number}", run.mission.name
        why = f": {run.reason}" if run.reason else ""
        if run.over:
            word, level = _ENDED[run.phase]
            if run.phase == "done" and run.skipped:
                level, why = "warning", f", {len(run.skipped)} places left out"
            if run.decided_by:
                word = f"Cancelled by {run.decided_by}"  # nothing else of it is a person's to end
            return [Over(now, key, f"{word}{why}", level)]
        found: list[Happening] = []
        if first:
            found.append(Began(run.started, "mission", key, f"Mission {name}", who=run.by))
        if run.phase == "paused" and (run.reason or run.decided_by):
            found.append(
                Happened(
                    *(now, "mission", f"Mission {name} paused", run.reason, "warning"),
                    who=run.decided_by,
                )
            )
        elif run.phase == "asking":
            found.append(
                Happened(now, "mission", f"Mission {name} waits for a person", level="warning")
            )
        return found
