"""The same drives on the real stack and in virtual time: outcome, firings, recovery.

.venv/bin/python benchmarks/drill_fidelity.py [COUNT] [FIRST] [FILE] [TURNS]

Real drives take their time, some 40 s each; COUNT of them, from number FIRST on, each TURNS times:
how far reality agrees with itself is as much as a drill can agree with it. FILE keeps them: what
is in it was driven before, and is only compared once more.
"""

from __future__ import annotations

import itertools
import os
import statistics
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
import rclpy
from kompass_interfaces.msg import ProcessState, StackState
from rclpy.signals import SignalHandlerOptions

from kompass.drills.drive import DriveResult
from kompass.drills.facts import DriveEnded
from kompass.drills.judge import judge
from kompass.drills.runner.observer import Observer
from kompass.drills.runner.operator import Operator, planner_node
from kompass.drills.runner.pool import ENVIRONMENT
from kompass.drills.runner.run import AFTERWARDS, SETTLED
from kompass.drills.runner.worker import Order, make_drives, stack_of
from kompass.drills.scenario import Goal, Scenario, ScheduledFault
from kompass.launch.stack import Stack as Described
from kompass.rclpy_ext.executor import TaskExecutor
from kompass.rclpy_ext.node import PlainNode
from kompass.rclpy_ext.qos import LATCHED_PROFILE
from kompass.supervisor.news import ProcessCondition, ProcessNews
from tests.support.stack import Stack

RECIPE = Path(__file__).parents[1] / "recipes" / "03_events_and_actions.py"
# From where the world has the robot start; ways of 2 to 4 m.
GOALS = ((1.0, 1.6), (-1.0, 1.6), (1.9, 0.0), (0.0, -1.7), (0.6, 0.6))
FAULTS = (
    ("", 0.0),
    ("lidar_unplugged", 4.0),
    ("kill:controller", 0.0),
    ("boxed_in", 8.0),
    ("odometry_silent", 4.0),
    ("stop:controller", 6.0),
    ("way_blocked", 8.0),
    ("kill:drive_manager", 0.0),
    ("person_ahead", 6.0),
    ("kill:planner", 0.0),
    ("wheel_blocked", 5.0),
    ("stop:drive_manager", 2.0),
    ("localizer_jump:0.5", 5.0),
    ("scan_late:0.5", 5.0),
    ("stop:planner", 5.0),
    ("kill:monitor", 0.0),
)
SENT, BROKEN = 2.0, 8.0  # s after the drive's beginning
WITHIN = 0.3  # s between recovery here and there, in the median
PATIENCE = 30.0  # s for a real stack's topics


def scenario(number: int) -> Scenario:
    """Goals and faults, each in turn, so that few drives already have many of both."""
    name, duration = FAULTS[number % len(FAULTS)]
    x, y = GOALS[number % len(GOALS)]
    faults = (ScheduledFault(name=name, at=BROKEN, duration=duration),) if name else ()
    goal = Goal(x=x, y=y, tolerance=0.1, at=SENT)
    title = f"{number} {name or 'no fault'}"
    return Scenario(
        name=title, world="hexagon", seed=number, goals=(goal,), faults=faults, limit=60.0
    )


def real_drive(described: Described, drive: Scenario) -> DriveResult:
    """Let a drive happen in real processes, over DDS, in real time."""
    # Only what a drill sets for its drives, too: the rest is as a user has it.
    stack = Stack.simulated("--sim=hexagon", recipe=RECIPE, **ENVIRONMENT)
    context = rclpy.Context()
    rclpy.init(
        args=[],
        context=context,
        domain_id=stack.domain,
        signal_handler_options=SignalHandlerOptions.NO,
    )
    node = PlainNode("people", context=context)
    executor = TaskExecutor(context)
    executor.add_node(node)
    try:
        return _drive(described, drive, node, executor)
    finally:
        executor.shutdown()
        node.destroy_node()
        context.try_shutdown()
        stack.close()


def _drive(
    described: Described, drive: Scenario, node: PlainNode, executor: TaskExecutor
) -> DriveResult:
    components = described.components
    names = [component.node_name for component in components]
    planner = planner_node(components)
    observer = Observer(node, names)
    operator = Operator(node, drive, components, observer)
    news = News(observer, operator, planner)
    node.create_subscription(StackState, "monitor/stack_state", news.on_state, LATCHED_PROFILE)

    def spin_until(end: float) -> None:
        while time.monotonic() < end:
            executor.spin_once(timeout_sec=min(0.1, max(0.0, end - time.monotonic())))

    late = time.monotonic() + PATIENCE
    while not news.all_active:
        if time.monotonic() > late:
            raise RuntimeError("nobody tells of the processes")
        executor.spin_once(timeout_sec=0.1)
    spin_until(time.monotonic() + SETTLED)
    observer.begin()
    while not operator.is_done and observer.now < drive.limit:
        executor.spin_once(timeout_sec=0.1)
    left = min(AFTERWARDS, drive.limit - observer.now)
    spin_until(time.monotonic() + left)
    operator.finish()
    observer.note(DriveEnded)
    return judge(drive, tuple(observer.facts))


class News:
    """What the supervisor tells of processes, as the monitor passes it on.

    Parameters
    ----------
    observer, operator
        Who is told.
    planner
        Node without which nobody answers a goal.
    """

    def __init__(self, observer: Observer, operator: Operator, planner: str) -> None:
        self._observer, self._operator, self._planner = observer, operator, planner
        self._known: dict[str, tuple[str, int]] = {}

    @property
    def all_active(self) -> bool:
        """Whether the stack is up."""
        return bool(self._known) and all(state == "active" for state, _ in self._known.values())

    def on_state(self, message: StackState) -> None:
        """Pass on what has changed."""
        for each in message.processes:
            now = (each.state, each.pid)
            before = self._known.get(each.name)
            if before == now:
                continue
            self._known[each.name] = now
            if before is not None and before[1] != each.pid and before[0] not in ("dead", "stuck"):
                # Who tells of deaths was dead itself.
                self._tell(each, "dead")
            self._tell(each, each.state)

    def _tell(self, process: ProcessState, state: ProcessCondition) -> None:
        told = ProcessNews(
            process.name, list(process.nodes), state, process.pid, reason=process.reason
        )
        self._observer.on_news(told)
        if self._planner in told.nodes:
            self._operator.planner_changed(state)


def fired(drive: DriveResult) -> list[str]:
    """Rules in the order in which they fired."""
    return [firing.rule_id for firing in drive.firings]


def agree(one: DriveResult, other: DriveResult) -> tuple[bool, bool]:
    """Whether two drives ended alike, and whether the same rules fired in the same order."""
    return one.outcome == other.outcome, fired(one) == fired(other)


def main() -> None:
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 40
    first = int(sys.argv[2]) if len(sys.argv) > 2 else 0
    file = Path(sys.argv[3]) if len(sys.argv) > 3 else None
    turns = int(sys.argv[4]) if len(sys.argv) > 4 else 1
    kept = _kept(file)
    drives = [scenario(number) for number in range(first, first + count)]
    orders = [Order(RECIPE, drive) for drive in drives]
    # This one ends before its niceness and environment could change what is compared with it.
    before = dict(os.environ)
    made = dict(make_drives(orders, 1))
    os.environ.clear()
    os.environ.update(before)
    described = stack_of(RECIPE)
    same_outcome = same_firings = 0
    apart: list[float] = []
    real_pairs: list[tuple[bool, bool]] = []
    for number, drive in enumerate(drives):
        virtual = DriveResult.model_validate_json(made[number])
        reals = [each for each in kept.get(drive.name, []) if each.scenario == drive][:turns]
        while len(reals) < turns:
            reals.append(real_drive(described, drive))
            if file is not None:
                with file.open("a") as lines:
                    lines.write(reals[-1].model_dump_json() + "\n")
        for real in reals:
            outcome, firings = agree(real, virtual)
            same_outcome += outcome
            same_firings += firings
            there, here = (
                each.faults[0].recovered_after if each.faults else None for each in (real, virtual)
            )
            if there is not None and here is not None:
                apart.append(there - here)
            print(
                f"{drive.name:26} {real.outcome:>13} {virtual.outcome:>13} "
                f"{'' if outcome else '✗':1}  recovery {_seconds(there)} {_seconds(here)}  "
                f"to the goal {_seconds(real.time_to_goal)} {_seconds(virtual.time_to_goal)}  "
                f"{len(real.firings)} {len(virtual.firings)} fired {'' if firings else '✗'}  "
                f"(load {os.getloadavg()[0]:.0f})",
                flush=True,
            )
            if os.environ.get("SHOW") or not (outcome and firings):
                for each, where in ((real, "real"), (virtual, "virtual")):
                    print(f"    {where}: {each.why}")
                    for moment in each.moments:
                        print(f"      {moment.at:7.2f} {moment.kind:9} {moment.text}")
        real_pairs += [agree(*pair) for pair in itertools.combinations(reals, 2)]
    print(
        f"\n{same_outcome} of {count * turns} with the same outcome, {same_firings} with the same "
        "firings in the same order"
    )
    if real_pairs:
        outcomes, sequences = (sum(same) for same in zip(*real_pairs, strict=True))
        print(
            f"real drives of one scenario with each other: of {len(real_pairs)} pairs {outcomes} "
            f"with the same outcome, {sequences} with the same firings"
        )
    if apart:
        sizes = [abs(each) for each in apart]
        print(
            f"recovery, real less virtual: median {statistics.median(apart):+.2f} s "
            f"({min(apart):+.2f} … {max(apart):+.2f}); of the differences' sizes "
            f"{statistics.median(sizes):.2f} s (aim {WITHIN} s), {len(apart)} drives"
        )


def _kept(file: Path | None) -> dict[str, list[DriveResult]]:
    kept: dict[str, list[DriveResult]] = {}
    if file is not None and file.exists():
        for line in file.read_text().splitlines():
            drive = DriveResult.model_validate_json(line)
            kept.setdefault(drive.scenario.name, []).append(drive)
    return kept


def _seconds(value: float | None) -> str:
    return "     –" if value is None else f"{value:6.2f}"


if __name__ == "__main__":
    main()
