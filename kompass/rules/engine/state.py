"""The state of the engine between two steps."""

from collections import deque
from collections.abc import Iterable
from typing import Any, Final, NamedTuple

from kompass.rules.engine.compiled_table import CompiledTable, RulePlan
from kompass.rules.engine.firing import LeafVerdict
from kompass.rules.schema.values import MISSING, Verdict

# Phases of what is due at one moment: verdicts of leaves, rules to look at, what rules wait for.
LEAF, LOOK, HOLD, QUEUE = 0, 1, 2, 3

# Whether a rule that fires on becoming true may do so.
WAITS_FOR_FALSE: Final = 0  # was never seen false
ARMED: Final = 1
SPENT: Final = 2  # has fired; waits for false, or for `clear`


class Waiting(NamedTuple):
    """A trigger in the queue of its rule."""

    at: float
    topic: str | None
    message: Any
    messages: dict[str, Any]
    leaves: tuple[LeafVerdict, ...]


class RuleState:
    """The state of one rule."""

    __slots__ = (
        "armed",
        "close",
        "cooldown_end",
        "dropped",
        "error",
        "evaluated",
        "failed",
        "fired",
        "hold_timer",
        "last_fired",
        "latched_at",
        "live",
        "missed",
        "queue",
        "queue_timer",
        "recent",
        "rose",
        "runs",
        "since",
        "true",
        "verdict",
    )

    def __init__(self, plan: RulePlan) -> None:
        event = plan.rule.event
        self.verdict: Verdict = None
        self.since: float | None = None  # true without a break since
        self.armed = (
            WAITS_FOR_FALSE if event.trigger == "edge" and not event.first_true_is_edge else ARMED
        )
        self.live = False  # wants every message of its topics
        self.cooldown_end = float("-inf")
        self.runs: dict[int, float] = {}  # run id -> when it started
        self.queue: deque[Waiting] = deque()
        self.recent: deque[float] = deque(maxlen=event.max_rate.count if event.max_rate else 1)
        self.latched_at: float | None = None
        self.hold_timer = False  # whether the schedule has an entry for it
        self.queue_timer = False
        self.evaluated = 0  # to be added to the counts of its topics
        self.true = 0
        self.rose = 0  # evaluations before it became true, for rules that are not `live`
        self.fired = 0
        self.dropped = 0
        self.failed = 0
        self.last_fired: float | None = None
        self.error = ""
        self.close = False  # whether all of its parts but one were true
        self.missed: dict[str, float] = {}  # when it last came close, by the sort of miss

    def copy(self) -> "RuleState":
        """Return an independent copy; messages are shared."""
        twin = object.__new__(RuleState)
        for name in RuleState.__slots__:
            setattr(twin, name, getattr(self, name))
        twin.runs = dict(self.runs)
        twin.queue = self.queue.copy()
        twin.recent = self.recent.copy()
        twin.missed = dict(self.missed)
        return twin


class EngineState:
    """The state of the engine; opaque outside of this package.

    ``step`` changes it in place. Make it with :func:`initial_state`, duplicate it with
    :meth:`copy`. Lists are indexed as the compiled table numbers its topics, signals and leaves.
    """

    __slots__ = (
        "begun",
        "counts",
        "fresh",
        "idle",
        "live",
        "messages",
        "next_run",
        "now",
        "received",
        "references",
        "rules",
        "schedule",
        "seen",
        "times",
        "values",
        "verdicts",
    )

    def __init__(self, table: CompiledTable, now: float) -> None:
        self.now = now
        topics = len(table.topics)
        self.counts = [0] * topics
        self.received: list[float | None] = [None] * topics
        self.messages: list[Any] = [None] * topics
        # False: the next message evaluates every leaf of the topic anew.
        self.fresh = [False] * topics
        # Timers with nothing to wait for until the next message of their topic.
        self.idle: list[list[int]] = [[] for _ in range(topics)]
        # Rules that want every message of the topic.
        self.live: list[set[int]] = [set() for _ in range(topics)]
        self.times: list[deque[float]] = [deque(maxlen=p.history) for p in table.topics]
        self.values: list[Any] = [MISSING] * len(table.probes)
        self.seen: list[float | None] = [None] * len(table.probes)
        self.verdicts: list[Verdict] = [None] * len(table.leaves)
        self.references: list[Any] = [MISSING] * len(table.leaves)
        self.begun: list[float | None] = [None] * len(table.timers)
        # Heap of (when, phase, index of the timer or rule): one entry at most for each.
        self.schedule: list[tuple[float, int, int]] = []
        self.rules = [RuleState(plan) for plan in table.rules]
        self.next_run = 1

    def copy(self) -> "EngineState":
        """Return an independent copy; messages are shared."""
        twin = object.__new__(EngineState)
        for name in EngineState.__slots__:
            value = getattr(self, name)
            setattr(twin, name, value.copy() if isinstance(value, list) else value)
        twin.idle = [timers.copy() for timers in self.idle]
        twin.live = [rules.copy() for rules in self.live]
        twin.times = [times.copy() for times in self.times]
        twin.rules = [rule.copy() for rule in self.rules]
        return twin

    def enlist(self, plan: RulePlan, topics: Iterable[int]) -> None:
        """Have a rule looked at with every message of these topics."""
        self.rules[plan.index].live = True
        for topic in topics:
            self.live[topic].add(plan.index)

    def delist(self, plan: RulePlan) -> None:
        """Undo :meth:`enlist`."""
        self.rules[plan.index].live = False
        for topic in plan.topics:
            self.live[topic].discard(plan.index)


class Counters(NamedTuple):
    """What a rule has done since the state was made, or since the rule was reset.

    Attributes
    ----------
    evaluated
        Messages of the topics of its condition.
    true
        Those after which the condition was true.
    fired
        Runs started.
    dropped
        Triggers that came while it was running (with no room in its queue) or cooling down.
    failed
        Runs that ended badly.
    last_fired
        Monotonic seconds; None if it never fired.
    running, waiting
        Runs in progress, and triggers in the queue.
    error
        What the last failed run said.
    """

    evaluated: int
    true: int
    fired: int
    dropped: int
    failed: int
    last_fired: float | None
    running: int
    waiting: int
    error: str


def counters(table: CompiledTable, state: EngineState, rule_id: str) -> Counters:
    """Return the counters of a rule.

    Raises
    ------
    KeyError
        If the table has no such rule.
    """
    plan = table.by_id[rule_id]
    rule = state.rules[plan.index]
    seen = evaluated(plan, state)
    lasting = seen - rule.rose if rule.verdict is True and not plan.listening else 0
    return Counters(
        evaluated=seen,
        true=rule.true + lasting,
        fired=rule.fired,
        dropped=rule.dropped,
        failed=rule.failed,
        last_fired=rule.last_fired,
        running=len(rule.runs),
        waiting=len(rule.queue),
        error=rule.error,
    )


def evaluated(plan: RulePlan, state: EngineState) -> int:
    """Return the number of messages that concerned a rule since the state began."""
    own = state.rules[plan.index].evaluated
    if not plan.rule.enabled:
        return own
    return own + sum(state.counts[topic] for topic in plan.topics)
