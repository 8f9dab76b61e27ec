"""How late messages come, told by their stamps as far as those can be believed."""

# s; a sensor is not this far ahead of its reader but by another clock. Two that are kept in step
# over a network are some milliseconds apart.
AHEAD = 0.1
# s; nothing that was never seen to be younger has been under way for so long: its clock is another.
LONGEST = 10.0


class Lateness:
    """Judges the stamps of one source. Times are arguments, of the wall clock [s].

    A stamp is believed when it lies at most :data:`AHEAD` in the future and :data:`LONGEST` in the
    past. A source that has been believed once is believed to be later than that, too: its clock was
    right, so the way has become long. All other stamps are of a clock that was never set, runs
    elsewhere, or is that of a recording: they tell nothing, and age counts from the arrival.

    Clocks that are less than :data:`LONGEST` apart, the source's behind, cannot be told from a long
    way. Then what comes counts as old, which errs to the safe side, and :attr:`note` says it.

    Attributes
    ----------
    late
        By how much the newest message was late when it came [s]; 0 when nobody knows.
    note
        What is wrong with its stamps; empty when nothing is.
    """

    def __init__(self) -> None:
        self.late = 0.0
        self.note = ""
        self._believed = False

    def heard(self, stamp: float, now: float) -> None:
        """Take in that a message of a stamp came; 0 is no stamp."""
        late = now - stamp
        self.late, self.note = 0.0, ""
        if stamp == 0.0:
            return
        if late < -AHEAD:
            self.note = (
                f"stamps lie {-late:.1f} s in the future: set the clocks of both machines; ages "
                "count from the arrival meanwhile"
            )
        elif late > LONGEST and not self._believed:
            self.note = (
                f"stamps lie {late:.0f} s in the past, as those of another clock do: set the "
                "clocks of both machines; ages count from the arrival meanwhile"
            )
        else:
            self._believed = True
            self.late = max(0.0, late)

    @property
    def told(self) -> str:
        """In words, for one that is too old: how late it comes."""
        return f"it comes {self.late:.1f} s after its stamp (a slow way, or clocks that differ)"
