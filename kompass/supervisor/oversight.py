"""What is told of processes, which is killed, and when one is started again.

No clock and no processes here: the supervisor carries it out, and virtual time does with processes
of its own.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from kompass.supervisor.liveness import Condition, LivenessLimits, Observation, assess_liveness
from kompass.supervisor.news import ProcessCondition, ProcessNews
from kompass.supervisor.restarts import Restarts

_HELD = "the process was stopped by a signal while it came up"


class StartupError(RuntimeError):
    """A process could not start; the message is meant for the terminal."""


@dataclass
class Life:
    """One life of a process, as far as it is known to who oversees it.

    Attributes
    ----------
    name
        Of the process.
    nodes
        ROS nodes in it.
    pid, born
        No other life has both; ``born`` in clock ticks since boot.
    restarts
        How often it was started before.
    began
        When [monotonic s].
    active
        Whether it works: before that, nobody expects life of it.
    stopped
        Since when a signal (SIGSTOP) holds it [monotonic s]; None while none does.
    told_stopped
        Whether those who listen know that.
    killed
        Why it is killed; empty while it is not.
    conditions
        Of each member.
    stuck_since
        Since when one of them is [monotonic s].
    lost_since
        Since when one of them is not expected to come back by itself [monotonic s].
    """

    name: str
    nodes: Sequence[str]
    pid: int
    born: int
    restarts: int
    began: float
    active: bool = False
    stopped: float | None = None
    told_stopped: bool = False
    killed: str = ""
    conditions: dict[str, Condition] = field(default_factory=dict)
    stuck_since: float | None = None
    lost_since: float | None = None

    @property
    def members(self) -> Sequence[str]:
        """Whose conditions are assessed and told one by one: its nodes, or itself."""
        return self.nodes or [self.name]


@dataclass(frozen=True)
class Changed:
    """A member of a process is in another condition than before."""

    member: str
    before: Condition
    now: Condition
    reason: str


@dataclass(frozen=True)
class Assessed:
    """What came of a look at a process.

    Attributes
    ----------
    changes
        Of its members.
    kill
        Why it is to be killed; empty when it is not.
    """

    changes: Sequence[Changed]
    kill: str


@dataclass(frozen=True)
class Death:
    """What is to be done about a death.

    Attributes
    ----------
    delay
        After which it is started again [s]; None when it is given up.
    text
        Why it is given up.
    """

    delay: float | None
    text: str = ""


class Oversight:
    """Over all processes of a stack.

    Parameters
    ----------
    limits
        When a process counts as busy or stuck, and when one that is stuck is killed.
    restarts
        How often, and after what delay, one that died is started again.
    tell
        Given what all who listen are told.
    """

    def __init__(
        self,
        limits: LivenessLimits | None,
        restarts: Restarts | None,
        tell: Callable[[ProcessNews], object],
    ) -> None:
        self._limits, self._restarts = limits or LivenessLimits(), restarts or Restarts()
        self._tell_all = tell
        self._newest: dict[str, ProcessNews] = {}

    @property
    def newest(self) -> Iterator[ProcessNews]:
        """The last that was told of each process: for who begins to listen."""
        return iter(self._newest.values())

    def tell(self, life: Life, state: ProcessCondition, reason: str = "") -> None:
        """Tell those who listen how a process is doing."""
        for member in life.members:
            self._tell_member(life, member, state, reason)

    def activate(self, life: Life) -> None:
        """Take that a process works."""
        life.active = True
        self.tell(life, "active")

    def may_be_computing(self, life: Life, silent: float) -> bool:
        """Whether it matters what a process does that was silent, or a part of it, so long [s]."""
        return life.stopped is None and silent > self._limits.silent / 2

    def assess(
        self,
        life: Life,
        now: float,
        silent: float,
        lags: Mapping[str, float | None],
        *,
        computing: bool = False,
        waited: float = 0.0,
        allowed: Mapping[str, float] | None = None,
    ) -> Assessed:
        """Look at the heartbeats of a process that works, and tell what has changed.

        Parameters
        ----------
        life
            Of the process.
        now
            Monotonic time [s].
        silent, lags, computing, waited, allowed
            As of :class:`kompass.supervisor.liveness.Observation`; lags of all members, and
            allowances of those that have one, by their names.
        """
        changes: list[Changed] = []
        is_lost = False
        for member in life.members:
            judged = assess_liveness(
                Observation(
                    silent=silent,
                    lag=lags[member],
                    stopped=None if life.stopped is None else now - life.stopped,
                    computing=computing,
                    waited=waited,
                    allowed=(allowed or {}).get(member, 0.0),
                ),
                self._limits,
            )
            condition, reason = judged.condition, judged.reason
            is_lost = is_lost or judged.is_lost
            before = life.conditions.get(member, "active")
            newly_stopped = life.stopped is not None and not life.told_stopped
            if condition != before or newly_stopped:
                changes.append(Changed(member, before, condition, reason))
                life.conditions[member] = condition
                self._tell_member(life, member, condition, reason, life.stopped is not None)
        life.told_stopped = life.stopped is not None
        kill, killed = "", self._limits.killed
        stuck = "stuck" in life.conditions.values()
        life.stuck_since = _since(life.stuck_since, stuck, now)
        life.lost_since = _since(life.lost_since, is_lost, now)
        if killed is not None and life.lost_since is not None and now - life.lost_since >= killed:
            assert life.stuck_since is not None, "what is lost is stuck"
            kill = f"it was stuck for {now - life.stuck_since:.0f} s"
        return Assessed(changes, kill)

    def assess_start(self, life: Life, now: float) -> Assessed:
        """Look at a process that does not work yet, and tell when a signal holds it.

        No heartbeats are expected of it, and how long it takes to come up is nobody's business
        here. But one that is held comes up never: in a life after the first it is to be killed, as
        one that works would be.

        Parameters
        ----------
        life
            Of the process.
        now
            Monotonic time [s].
        """
        held = 0.0 if life.stopped is None else now - life.stopped
        is_told = held >= self._limits.stopped
        if is_told and not life.told_stopped:
            for member in life.members:
                self._tell_member(life, member, "stuck", _HELD, stopped=True)
        elif life.told_stopped and life.stopped is None:
            self.tell(life, "starting")
        life.told_stopped = is_told or (life.told_stopped and life.stopped is not None)
        killed, kill = self._limits.killed, ""
        if killed is not None and self._restarts.ever_died(life.name):
            over = held - self._limits.stopped >= killed
            kill = f"it was held by a signal for {held:.0f} s while it came up" if over else ""
        return Assessed((), kill)

    def bury(self, life: Life, reason: str) -> None:
        """Tell of a death; ``reason`` is what is known of it where nobody has willed it."""
        self.tell(life, "dead", life.killed or reason)

    def after_death(self, life: Life, now: float, *, failed: bool, restart: bool = True) -> Death:
        """Tell what is to be done about a death that was told of.

        Parameters
        ----------
        life
            Of the process.
        now
            Monotonic time [s].
        failed
            Whether it ended otherwise than in order.
        restart
            Whether it is to be started again at all.

        Raises
        ------
        StartupError
            When it has never worked.
        """
        name = life.name
        if not life.active and not self._restarts.ever_died(name) and failed:
            raise StartupError(f"{name} could not start; its reason is above")
        if not restart:
            return Death(None)
        delay = self._restarts.after_death(name, now - life.began)
        if delay is not None:
            return Death(delay)
        text = f"died {self._restarts.in_a_row(name)} times in a row"
        self.tell(life, "given up", text)
        return Death(None, text)

    def _tell_member(
        self,
        life: Life,
        member: str,
        state: ProcessCondition,
        reason: str,
        stopped: bool = False,
    ) -> None:
        shared = len(life.members) > 1
        name = member if shared else life.name
        nodes = [member] if shared else list(life.nodes)
        told = (name, nodes, state, life.pid, life.restarts, reason, stopped, life.born)
        news = self._newest[name] = ProcessNews(*told)
        self._tell_all(news)


def _since(before: float | None, holds: bool, now: float) -> float | None:
    """Since when something holds; None while it does not."""
    if not holds:
        return None
    return now if before is None else before
