"""The engine with its inputs and its runs, as workers use it while it goes on."""

from __future__ import annotations

from collections.abc import Collection
from functools import partial
from typing import NamedTuple

from kompass.monitor.engine_loop import EngineLoop, Swap
from kompass.monitor.execution.publishers import Publishers, Target
from kompass.monitor.execution.runs import Runs
from kompass.monitor.inputs.polled_functions import PolledFunctions
from kompass.monitor.inputs.rule_inputs import RuleInputs, topics_of
from kompass.rclpy_ext.main_thread import MainThread
from kompass.rulebook.views.views import Extras
from kompass.rules.engine.compiled_table import CompiledTable
from kompass.rules.engine.migration import plan_migration
from kompass.rules.engine.state import EngineState


class EngineSnapshot(NamedTuple):
    """The engine at one moment; a copy, which nobody changes.

    Attributes
    ----------
    now
        Monotonic seconds.
    table
        The table in force.
    state
        What it knew.
    """

    now: float
    table: CompiledTable
    state: EngineState


class LiveEngine:
    """Puts tables in force: engine, inputs and runs change together, between two messages.

    The methods may be called from any thread; the work is done on the executor's, in pieces that
    hold up no message for long. Only one caller at a time may change the table.

    Parameters
    ----------
    main
        The executor's thread.
    loop
        The engine.
    inputs, polled
        What the engine is fed with.
    runs
        What its firings began.
    publishers
        What its rules publish with.
    """

    def __init__(
        self,
        main: MainThread,
        loop: EngineLoop,
        inputs: RuleInputs,
        polled: PolledFunctions,
        runs: Runs,
        publishers: Publishers,
    ) -> None:
        self._main, self._loop, self._inputs = main, loop, inputs
        self._polled, self._runs, self._publishers = polled, runs, publishers

    def begin(self) -> None:
        """Listen to what the table in force needs, and let time pass for it."""
        table = self._loop.table
        self._follow(table, topics_of(table), self._publishers.targets(table.table))
        self._loop.begin()

    def prepare(self, table: CompiledTable) -> None:
        """Listen to the topics of a table that is about to come, and be ready to publish."""
        for name, kind in topics_of(table).items():
            # Asked on this thread: whoever calls this is the only one who has topics listened to.
            if not self._inputs.listens_to(name):
                # One at a time: the engine goes on between two subscriptions.
                self._main.call(partial(self._inputs.prepare, {name: kind}))
        for target in self._publishers.targets(table.table):
            if not self._publishers.is_open(target):
                self._main.call(partial(self._publishers.prepare, (target,)))

    def swap(
        self, table: CompiledTable, revision: int, reset: Collection[str], cancel: str
    ) -> Swap:
        """Put a table in force.

        Parameters
        ----------
        reset
            Ids of rules that start afresh though they are unchanged.
        cancel
            Why running actions of what changes are cancelled; empty lets them finish.
        """
        # Whoever calls this is the only one who changes the table in force.
        plan, topics = plan_migration(self._loop.table, table, reset), topics_of(table)
        targets = self._publishers.targets(table.table)

        def between_messages() -> Swap:
            swap = self._loop.swap(plan, revision, reset)
            self._follow(table, topics, targets)
            if cancel:
                self._runs.cancel(swap.carried.running, cancel)
            self._runs.forget((*swap.carried.reset, *swap.carried.removed))
            return swap

        return self._main.call(between_messages)

    @property
    def in_force(self) -> CompiledTable:
        """The table in force; may be asked from any thread."""
        return self._loop.table

    def running(self) -> frozenset[str]:
        """Ids of the rules whose actions are running."""
        return self._main.call(self._runs.running)

    def snapshot(self) -> EngineSnapshot:
        """The table in force and a copy of the engine's state."""
        loop = self._loop
        return self._main.call(lambda: EngineSnapshot(loop.now, loop.table, loop.state.copy()))

    def extras(self, rule_id: str) -> Extras:
        """What is known of a rule outside the engine; to be asked on the executor's thread."""
        extras = self._runs.extras(rule_id)
        if self._inputs.broken:
            table = self._loop.table
            for topic in table.by_id[rule_id].topics:
                why = self._inputs.broken.get(table.topics[topic].name)
                if why:
                    return extras._replace(broken=why)
        return extras

    def _follow(
        self, table: CompiledTable, topics: dict[str, str], targets: frozenset[Target]
    ) -> None:
        self._inputs.follow(topics)
        self._publishers.follow(targets)
        self._polled.follow(table)
