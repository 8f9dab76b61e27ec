"""What people did by STOP and the wheel, as the drive manager tells."""

from kompass_interfaces.msg import DriveState

LATE = 0.25  # s from when something was said to when it is heard, for whoever was held meanwhile
# s after it was held in which what waited meanwhile is still handed to it.
HELD_OVER = 1.0


class People:
    """Whether somebody stops the robot or drives it by hand, or did so unnoticed."""

    def __init__(self) -> None:
        self.stopped = ""  # who pressed STOP, in a clause; empty when nobody did
        self.driven = ""  # who drives by hand
        self._interruptions: int | None = None
        self._missed = -float("inf")

    def hear(self, state: DriveState, now: float, wall: float) -> bool:
        """Take in what the drive manager tells; whether what is under way is over.

        Parameters
        ----------
        now, wall
            Monotonic, and of the calendar [s].
        """
        self.stopped = f"{state.stopped_by} pressed STOP" if state.stopped else ""
        self.driven = f"{state.driven_by} drives by hand" if state.driven_by else ""
        before, self._interruptions = self._interruptions, state.interruptions
        came = before not in (None, state.interruptions)
        age = wall - state.header.stamp.sec - 1e-9 * state.header.stamp.nanosec
        if came and (not (self.stopped or self.driven) or age > LATE):
            self._missed = now
        return bool(came or self.stopped or self.driven)

    def refusal(self, now: float) -> str:
        """Why nothing that was asked for may begin, in a sentence; empty when it may."""
        if self.stopped:
            return f"{self.stopped}; a person must release it first."
        if self.driven:
            return f"{self.driven}; the wheel must be given up first."
        if now - self._missed < HELD_OVER:
            # It may have been asked for before: which came first cannot be told.
            return "STOP was pressed, or the wheel taken, meanwhile; ask again if it is wanted."
        return ""
