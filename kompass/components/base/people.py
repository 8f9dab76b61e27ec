"""What people did by STOP and the wheel, as the drive manager tells."""

from kompass_interfaces.msg import DriveState

LATE = 0.25  # s from when something was said to when it is heard, for whoever was held meanwhile
# s after it was held in which what waited meanwhile is still handed to it.
HELD_OVER = 1.0


class People:
    """Whether somebody stops the robot or drives it by hand, or did so unnoticed.

    Attributes
    ----------
    stopped, driven
        Who pressed STOP, and who drives by hand, in a clause; empty when nobody does.
    interruptions
        How often people pressed STOP or took the wheel; None as long as nobody has told.
    """

    def __init__(self) -> None:
        self.stopped = self.driven = ""
        self.interruptions: int | None = None
        self._heard = -float("inf")
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
        before, self.interruptions = self.interruptions, int(state.interruptions)
        self._heard = now
        came = before not in (None, state.interruptions)
        age = wall - state.header.stamp.sec - 1e-9 * state.header.stamp.nanosec
        if came and (not (self.stopped or self.driven) or age > LATE):
            self._missed = now
        return bool(came or self.stopped or self.driven)

    def is_up_to_date(self, now: float) -> bool:
        """Whether the newest is known; who was held hears of it a moment after it goes on."""
        return self.interruptions is None or now - self._heard <= LATE

    def were_missed(self, now: float) -> bool:
        """Whether what comes now may be from before something that people did unnoticed."""
        return now - self._missed < HELD_OVER

    def came_since(self, interruptions: int | None) -> bool:
        """Whether people pressed STOP or took the wheel since there were so many interruptions.

        Where that was not known then, any that there have been may have come since.
        """
        return (self.interruptions or 0) != (interruptions or 0)

    def refusal(self, now: float) -> str:
        """Why nothing that was asked for may begin, in a sentence; empty when it may."""
        if self.stopped:
            return f"{self.stopped}; a person must release it first."
        if self.driven:
            return f"{self.driven}; the wheel must be given up first."
        if self.were_missed(now):
            # It may have been asked for before: which came first cannot be told.
            return "STOP was pressed, or the wheel taken, meanwhile; ask again if it is wanted."
        return ""
