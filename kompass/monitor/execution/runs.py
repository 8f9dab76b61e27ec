"""The runs of rules: which may begin, which must end, and what is told of each."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Coroutine, Iterable
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from kompass.monitor.reporting.entries import ActionOutcome, EntryKind, RunEntry
from kompass.monitor.reporting.firings import Firings
from kompass.rclpy_ext.executor import Task
from kompass.rulebook.views.views import Extras, leaf_reading
from kompass.rules.engine.arbitrate import Running, arbitrate, components_of
from kompass.rules.engine.compiled_table import CompiledTable
from kompass.rules.engine.firing import NO_RUN, Firing, Note, Output

Tell = Callable[[ActionOutcome], None]


@dataclass(eq=False)
class Run:
    """A run in progress.

    Attributes
    ----------
    entry
        What is told of its firing; made once the run has begun, for nothing of it waits for that.
    components
        Node names of the components that it acts on.
    number
        Of the entry in the journal.
    stopped
        Why it was cancelled; empty unless it was.
    untold
        What is to be told of it once its beginning has been told; None from then on.
    """

    firing: Firing
    components: frozenset[str]
    entry: RunEntry = field(init=False)
    number: int = 0
    task: Task | None = None
    ok: bool = False
    error: str = ""
    stopped: str = ""
    untold: list[Callable[[], None]] | None = field(default_factory=list)

    def tell(self, step: Callable[[], None]) -> None:
        """Tell a step of the run, after its beginning."""
        if self.untold is None:
            step()
        else:
            self.untold.append(step)


class Runs:
    """Carries out what the engine puts out.

    Parameters
    ----------
    perform
        Makes the coroutine that carries out the actions of a firing: whether all went well, and
        the first error.
    done
        Tells the engine that a run has ended.
    firings
        Tells of every step.
    """

    def __init__(
        self,
        perform: Callable[[Firing, Tell], Coroutine[Any, None, tuple[bool, str]]],
        done: Callable[[str, int, bool, str], None],
        firings: Firings,
    ) -> None:
        self._perform, self._done, self._firings = perform, done, firings
        self._runs: dict[tuple[str, int], Run] = {}
        self._outputs: deque[tuple[Output, _Origin]] = deque()
        self._busy = False
        self._extras: dict[str, Extras] = {}

    def extras(self, rule_id: str) -> Extras:
        """What is known of a rule's runs outside the engine."""
        return self._extras.get(rule_id, Extras())

    def forget(self, rule_ids: Iterable[str]) -> None:
        """Forget what is known of rules that start afresh, or are gone."""
        for rule_id in rule_ids:
            self._extras.pop(rule_id, None)

    def take(self, outputs: Iterable[Output], table: CompiledTable, revision: int) -> None:
        """Carry out what the engine put out, and what follows from that at once.

        Parameters
        ----------
        outputs
            In the order of the engine.
        table, revision
            That let it fire.
        """
        origin = _Origin(table, revision)
        self._outputs.extend((output, origin) for output in outputs)
        if self._busy:
            return
        self._busy = True
        try:
            while self._outputs:
                together = list(self._outputs)
                self._outputs.clear()
                self._take(together)
        finally:
            self._busy = False

    def cancel(self, runs: Iterable[tuple[str, int]], reason: str) -> None:
        """Cancel those of the runs that are in progress.

        Parameters
        ----------
        runs
            Ids of rule and run.
        reason
            Becomes the error with which they end.
        """
        for key in runs:
            run = self._runs.get(key)
            if run is not None and run.task is not None:
                run.stopped = reason
                run.task.cancel()

    def running(self) -> frozenset[str]:
        """Ids of the rules whose actions run."""
        return frozenset(rule_id for rule_id, _ in self._runs)

    def close(self) -> None:
        """End all that is in progress."""
        self.cancel(list(self._runs), "the monitor ends")

    def _take(self, outputs: list[tuple[Output, _Origin]]) -> None:
        firings: list[Firing] = []
        origins: dict[int, _Origin] = {}  # by run
        for output, origin in outputs:
            if isinstance(output, Note):
                self._firings.fired(_noted(output, origin), None)
            elif output.shadow:
                self._firings.fired(_entry(output, origin, "shadow"), output.message)
            else:
                firings.append(output)
                origins[output.run_id] = origin
        if not firings:
            return
        for firing in firings:
            self.cancel(
                ((firing.rule_id, run) for run in firing.cancels),
                f"run {firing.run_id} of the same rule took over",
            )
        settled = arbitrate(firings, [_running(run) for run in self._runs.values()])
        for loser in settled.preempted:
            by = next(f.rule_id for f in settled.start if loser.components & _wanted(f))
            self.cancel([(loser.rule_id, loser.run_id)], f"the more severe rule '{by}' took over")
        for lost in settled.outranked:
            entry = _entry(lost.firing, origins[lost.firing.run_id], "firing")
            self._lose(lost.firing, entry, lost.component, lost.winner_rule_id)
        # What keeps people safe begins first.
        for firing in sorted(settled.start, key=lambda f: f.lane != "safety"):
            self._start(firing, origins[firing.run_id])

    def _lose(self, firing: Firing, entry: RunEntry, component: str, winner: str) -> None:
        text = f"the more severe rule '{winner}' has {component}"
        extras = self.extras(firing.rule_id)
        self._extras[firing.rule_id] = extras._replace(outranked=extras.outranked + 1)
        self._firings.fired(entry._replace(kind="outranked", text=text), firing.message)
        self._done(firing.rule_id, firing.run_id, False, f"outranked: {text}")

    def _start(self, firing: Firing, origin: _Origin) -> None:
        run = Run(firing, _wanted(firing))
        self._runs[(firing.rule_id, firing.run_id)] = run
        self._firings.begins(origin.table.by_id[firing.rule_id].rule, firing.revision_hash)
        # What it starts is started first: telling of it takes longer.
        run.task = Task(self._carry_out(run), lambda error: self._over(run, error))
        run.entry = _entry(firing, origin, "firing")
        run.number = self._firings.fired(run.entry, firing.message)
        untold, run.untold = run.untold or (), None
        for step in untold:
            step()

    async def _carry_out(self, run: Run) -> None:
        def tell(outcome: ActionOutcome) -> None:
            run.tell(lambda: self._firings.acted(run.entry, run.number, outcome))

        run.ok, run.error = await self._perform(run.firing, tell)

    def _over(self, run: Run, error: BaseException | None) -> None:
        firing = run.firing
        del self._runs[(firing.rule_id, firing.run_id)]
        if error is not None:
            run.ok = False
            run.error = f"cancelled: {run.stopped}" if run.stopped else f"{error!r}"
        self._extras[firing.rule_id] = self.extras(firing.rule_id)._replace(last_ok=run.ok)
        run.tell(lambda: self._firings.ended(run.entry, run.number, run.ok, run.error))
        run.tell(lambda: self._done(firing.rule_id, firing.run_id, run.ok, run.error))


class _Origin(NamedTuple):
    """The table that let something fire; another one may be in force when that is told."""

    table: CompiledTable
    revision: int


def _entry(output: Output, origin: _Origin, kind: EntryKind) -> RunEntry:
    rule = origin.table.by_id[output.rule_id].rule
    return RunEntry(
        kind=kind,
        rule_id=rule.id,
        name=rule.name,
        once=rule.event.once,
        revision=origin.revision,
        run_id=NO_RUN if isinstance(output, Note) else output.run_id,
        at=output.at,
        rule_hash=output.revision_hash,
        severity=output.severity.name.lower(),
        topic=None if isinstance(output, Note) else output.topic,
        text=output.text if isinstance(output, Note) else "",
        leaves=tuple(map(leaf_reading, output.leaves)),
    )


def _noted(note: Note, origin: _Origin) -> RunEntry:
    return _entry(note, origin, "near miss" if note.kind == "near_miss" else "note")


def _wanted(firing: Firing) -> frozenset[str]:
    return components_of(firing.actions)


def _running(run: Run) -> Running:
    firing = run.firing
    return Running(firing.rule_id, firing.run_id, firing.severity, run.components)
