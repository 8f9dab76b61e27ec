"""The journal as users of the store see it: of this life of the monitor, and of this stack."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from kompass.rulebook.schema.journal import ActionRecord, FiringRecord, Journal
from kompass.store.journal import JournalFile, Refusal

HANGING = 0.5  # s after which a disk is not waited for


class JournalAccess:
    """Part of :class:`kompass.store.store.RuleStore`."""

    _journal: JournalFile
    _clock: Callable[[], float]
    _epoch: str
    _stack: str

    def record_firing(self, entry: FiringRecord) -> FiringRecord:
        """Add an entry to the journal, at once and without waiting; the same with its number."""
        return self._journal.record(entry)

    def finish_firing(
        self,
        number: int,
        *,
        ended: float,
        ok: bool,
        error: str = "",
        actions: Sequence[ActionRecord] = (),
    ) -> None:
        """Say how a run ended; ``ended`` in seconds since the epoch."""
        changes = {"ended": ended, "ok": ok, "error": error, "actions": tuple(actions)}
        self._journal.change(number, changes)

    def keep_recording(self, number: int, path: str) -> None:
        """Note the recording that was kept around a firing."""
        self._journal.change(number, {"recording": path})

    def journal(self, before: int = 0, count: int = 100, rule_id: str = "") -> Journal:
        """Entries below a number, newest first; from the newest if it is 0.

        Waits for entries that are being written: call it where waiting for a disk does no harm.
        """
        return self._journal.before(before, count, rule_id)

    def firing(self, epoch: str, run_id: int, rule_id: str = "") -> FiringRecord | None:
        """The entry of a run; None if the journal does not keep it any more. Waits as above."""
        return self._journal.run(epoch or self._epoch, run_id, rule_id)

    def near_misses(self, rule_id: str, count: int = 10) -> tuple[FiringRecord, ...]:
        """When a rule came close and did not fire, newest first. Waits as above."""
        return self._journal.kinds(rule_id, "near miss", count)

    @property
    def lost_entries(self) -> int:
        """Number of entries that the disk did not take since the start."""
        return self._journal.lost

    @property
    def journal_trouble(self) -> str:
        """Why the last entries could not be written; empty when they were."""
        return self._journal.trouble

    def refuse(self, *, author: str, role: str, what: str, text: str) -> None:
        """Note what a guard rail forbade."""
        self._journal.refuse(Refusal(self._clock(), author, role, what, text))

    def refusals(self, count: int = 100) -> list[Refusal]:
        """What guard rails forbade, newest first. Waits as above."""
        return self._journal.refusals(count)

    def use_once(self, rule_id: str, rule_hash: str) -> None:
        """Remember that a ``once`` rule has fired in this run of the stack.

        Unlike all else in the journal it is written before this returns, so that who is killed in
        the next moment has still had the one firing; a disk that hangs is not waited for.
        """
        self._journal.use(self._stack, rule_id, rule_hash, self._clock())
        self._journal.flush(HANGING)

    def reset_once(self, rule_id: str) -> None:
        """Let a ``once`` rule fire again in this run of the stack."""
        self._journal.forget_use(self._stack, rule_id)

    def used_once(self) -> set[tuple[str, str]]:
        """Ids and hashes of the ``once`` rules that have fired in this run of the stack."""
        return self._journal.used(self._stack)

    def flush(self, timeout: float = 5.0) -> bool:
        """Wait until the journal is written; whether it was within ``timeout`` seconds."""
        return self._journal.flush(timeout)
