"""Random drives of our own stack: all that may happen to it, and what must hold all the same.

A seed decides on all of it: recipe, table, edits, faults, STOP, the network. One drive again:

    scripts/drills 1 --from N --log
"""

from __future__ import annotations

import os
import random
import re
import tempfile
import traceback
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from kompass_interfaces.srv import SetFault

from kompass.components import Controller, DriveManager, LocalMapper, Planner
from kompass.control import ControllersID
from kompass.drills.course import Course
from kompass.drills.draw import fits
from kompass.drills.facts import (
    HEALTHY,
    ActionDone,
    Contact,
    DriveEnded,
    Fact,
    FaultBegan,
    ProcessEnded,
    ProcessStarted,
    RuleFired,
    RunDone,
    Status,
)
from kompass.drills.invariants import broken_invariants, firings_have_an_outcome
from kompass.drills.runner.observer import Observer
from kompass.drills.runner.operator import Operator, planner_node
from kompass.drills.scenario import Goal, OperatorAct, Scenario, ScheduledFault
from kompass.launch.stack import Stack, stacks_go_to
from kompass.launch.virtual_stack import VirtualStack
from kompass.ros import Launcher, Topic
from kompass.rules.schema.actions import Log
from kompass.rules.schema.table import Table
from kompass.simulation.faults.fault_names import FAULTS, NEEDS_CAMERA
from kompass.simulation.faults.fault_parameters import PARAMETERS
from kompass.simulation.faults.fault_service import SERVICE as SET_FAULT
from kompass.simulation.worlds.registry import world
from kompass.store.store import RuleStore
from kompass.supervisor.news import ProcessNews
from kompass.virtual.executor import VirtualExecutor
from kompass.virtual.network import Conditions
from kompass.virtual.node import VirtualNode
from kompass.virtual.process import World
from kompass.virtual.scheduler import SECOND, nanoseconds
from tests.drills.editor import Edit, Editor
from tests.drills.probes import Probes, probe_rules
from tests.support.turtlebot import turtlebot

RECIPES = Path(__file__).parents[2] / "recipes"
WRITTEN = ("01_point_navigation", "02_self_healing", "03_events_and_actions",
           "04_cross_component_healing")  # fmt: skip
PROCESSES = ("planner", "controller", "mapper", "drive_manager", "monitor", "halt", "map_server")
COMPONENTS = PROCESSES[:4]
DOORS = {"apartment": ("kitchen", "bath", "bedroom")}
SETTLED = 0.5  # s from the bring-up to the beginning
BACK = 3.0  # s after which a monitor that was killed is up again, and has said so
ANSWERED = 1.5  # s after STOP by which each goal has ended, and the robot stands
SPOKEN = 1.5  # s in which somebody speaks for whoever is gone
LOGGED = 1.0  # s in which a rule that only logs is done
AT_ONCE = 0.5  # s in which a goal that is sent under STOP is answered
HELD_UP = ("stop:", "starve:", "hang:", "flicker:")
# What breaks no wheel, no sense and nothing of the surroundings: the robot touches nothing.
HARMLESS = ("kill:", *HELD_UP, "wrong:", "map_withheld", "start_occupied", "lidar_unplugged",
            "odometry_silent", "scan_rate_halved")  # fmt: skip
AFTERMATH = 12.0  # s for which an error may be a fault's doing after that has ended
# What no fault of the robot's explains: a program that stumbles over itself.
OWN_MISTAKE = re.compile(
    r"\b(Type|Key|Attribute|Index|Name|Value|Runtime|Assertion|ZeroDivision|Recursion|"
    r"UnboundLocal|NotImplemented|InvalidState|InvalidHandle)(Error)?\b:"
)


@dataclass(frozen=True)
class RandomDrive:
    """All that happens in one drive, from its seed."""

    seed: int
    recipe: str  # of RECIPES, or empty for one that is drawn
    scenario: Scenario
    edits: tuple[Edit, ...]
    network: tuple[tuple[float, Conditions], ...]

    def __str__(self) -> str:
        scenario = self.scenario
        faults = ", ".join(f"{f.name}@{f.at:g}+{f.duration:g}" for f in scenario.faults)
        acts = ", ".join(f"{a.does}@{a.at:g}" for a in scenario.operators)
        edits = ", ".join(f"{e.kind}@{e.at:g}" for e in self.edits)
        conditions = ", ".join(f"{c.slowest:g} s/{c.loss:.0%}@{at:g}" for at, c in self.network)
        return (
            f"seed {self.seed}: {self.recipe or 'random recipe'} in {scenario.world}; "
            f"faults [{faults}]; people [{acts}]; edits [{edits}]; network [{conditions}]"
        )


@dataclass
class Outcome:
    """What came of one drive."""

    drive: str
    findings: list[str] = field(default_factory=list)
    facts: list[Fact] = field(default_factory=list)
    log: list[str] = field(default_factory=list)


# -- drawing ------------------------------------------------------------------------------------


def draw_drive(seed: int) -> RandomDrive:
    rng = random.Random(f"drive {seed}")
    place = rng.choices(("hexagon", "apartment", "warehouse"), (8, 1, 1))[0]
    recipe = rng.choice(("", "", *WRITTEN))
    limit = round(rng.uniform(5.0, 9.0), 1)
    scenario = Scenario(
        name=f"drive {seed}",
        world=place,
        seed=seed,
        goals=tuple(_goals(rng, place)),
        faults=tuple(_faults(rng, place, limit)),
        operators=tuple(_acts(rng, limit)),
        limit=limit,
    )
    edits = [
        Edit(round(rng.uniform(0.2, limit - 0.5), 2), kind, rng.randrange(1 << 30))
        for kind in rng.choices(
            ("apply", "confirm", "try", "rollback", "bad", "stale", "check"),
            (5, 4, 2, 3, 1, 1, 2),
            k=rng.choice((0, 1, 2, 4, 8)),
        )
    ]
    network = []
    if rng.random() < 0.4:
        slow = rng.choice((0.001, 0.005, 0.03))
        conditions = Conditions(slow / 10, slow, rng.choice((0.0, 0.02, 0.1)))
        network = [(round(rng.uniform(0.0, limit / 2), 2), conditions)]
        if rng.random() < 0.5:
            network.append((round(rng.uniform(limit / 2, limit), 2), Conditions()))
    return RandomDrive(
        seed, recipe, scenario, tuple(sorted(edits, key=lambda e: e.at)), tuple(network)
    )


def _goals(rng: random.Random, place: str) -> Iterator[Goal]:
    x, y, _ = world(place).start
    for index in range(rng.choice((1, 1, 2, 3))):
        # Some lie in a wall, or too far to get there in time: a goal has to end all the same.
        at = 0.2 if index == 0 else round(1.5 * index + rng.random(), 2)
        yaw = rng.choice((None, 0.0, 1.5))
        timed = index == 0 or rng.random() < 0.5
        yield Goal(
            x=round(x + rng.uniform(-2.0, 2.5), 2),
            y=round(y + rng.uniform(-2.0, 2.0), 2),
            yaw=yaw,
            at=at if timed else None,
        )


def _faults(rng: random.Random, place: str, limit: float) -> list[ScheduledFault]:
    found: list[ScheduledFault] = []
    burst = rng.random() < 0.4
    first = rng.uniform(0.4, limit / 2.0)
    for _ in range(rng.choice((0, 1, 1, 2, 3, 5))):
        name = _fault_name(rng, place)
        if any(each.name == name for each in found) or not fits(name, world(place)):
            continue
        at = first + rng.uniform(0.0, 0.4) if burst else rng.uniform(0.4, limit - 1.5)
        lasts = 0.0 if name.startswith("kill") else round(rng.choice((0.3, 1.0, 3.0, 0.0)), 1)
        if name == "map_withheld":
            at = 0.0
        found.append(ScheduledFault(name=name, at=round(at, 2), duration=lasts))
    return found


def _fault_name(rng: random.Random, place: str) -> str:
    if rng.random() < 0.5:
        return f"{rng.choice(('kill', 'kill', 'stop'))}:{rng.choice(PROCESSES)}"
    if rng.random() < 0.25:
        kind = rng.choice(("starve", "hang", "flicker", "wrong"))
        return f"{kind}:{rng.choice(COMPONENTS if kind == 'wrong' else PROCESSES)}"
    robot = [one for one in FAULTS if one not in NEEDS_CAMERA]
    whole = rng.choice([one for one in robot if not one.endswith(":NAME")])
    kind, _, word = whole.partition(":")
    if word == "DOORWAY":
        doors = [door.name for door in world(place).doorways]
        return f"{kind}:{rng.choice(doors)}" if doors else "way_blocked"
    return f"{kind}:{PARAMETERS[kind].example}" if word else kind


def _acts(rng: random.Random, limit: float) -> Iterator[OperatorAct]:
    if rng.random() < 0.35:
        at = rng.uniform(0.5, limit - 2.0)
        yield OperatorAct(at=round(at, 2), does="stop", by="ava", reason="a drill")
        if rng.random() < 0.6:
            at = rng.uniform(at + 0.05, limit - 0.5)
            yield OperatorAct(at=round(at, 2), does="release", by="ava")


# -- recipes ------------------------------------------------------------------------------------


def stack_of(drive: RandomDrive) -> tuple[Stack, dict[int, Any]]:
    """A fresh stack, and what answers its polled functions."""
    if drive.recipe:
        from kompass.drills.runner.worker import stack_of as recipe_stack

        return recipe_stack(RECIPES / f"{drive.recipe}.py"), {}
    # Only now, in the drive's own process: the drive manager there has a STOP of its own, which
    # all that are forked after it is made would share.
    from tests.recipe.random_recipes import DRIVER, PLANNER, Writer

    rng = random.Random(f"recipe {drive.seed}")
    written = Writer(rng).rules()
    planner: Planner = PLANNER
    planner.run_type = "ActionServer"
    driver: DriveManager = DRIVER
    controller = Controller("controller")
    controller.algorithm = rng.choice((ControllersID.PURE_PURSUIT, ControllersID.MPPI))
    controller.direct_sensor = rng.random() < 0.5
    components = [planner, controller, LocalMapper("mapper"), driver]
    launcher = Launcher()
    launcher.kompass(components, events_actions=written.first, multi_processing=rng.random() < 0.8)
    for made, action in written.later:
        launcher.on(made, [action])
    launcher.inputs(location=Topic(name="/odometry/filtered", msg_type="Odometry"))
    launcher.robot = turtlebot()
    stacks: list[Stack] = []
    with stacks_go_to(stacks.append):
        launcher.bringup()
    return stacks[0], written.asked


# -- driving ------------------------------------------------------------------------------------


def drive_once(seed: int) -> Outcome:
    """Make the drive of a seed, in this process, which is used up by it."""
    drive = draw_drive(seed)
    outcome = Outcome(str(drive))
    with tempfile.TemporaryDirectory(prefix="kompass-drill-") as folder:
        os.environ["KOMPASS_DATA_DIR"] = folder
        try:
            _drive(drive, outcome, Path(folder) / "drill")
        except Exception as error:  # noqa: BLE001 - what a program of ours raises is a finding
            where = "".join(traceback.format_tb(error.__traceback__)[-6:])
            outcome.findings.append(f"raised {type(error).__name__}: {error}\n{where}")
    return outcome


def _drive(drive: RandomDrive, outcome: Outcome, folder: Path) -> None:
    scenario = drive.scenario
    stack, asked = stack_of(drive)
    assert stack.monitored is not None
    recipe = stack.monitored.rules.table
    table = Table(rules=(*recipe.rules, *probe_rules()))
    rng = random.Random(f"happens {drive.seed}")
    with World(drive.seed) as virtual:
        robot = VirtualStack(
            virtual, stack, world(scenario.world), seed=drive.seed, table=table, folder=folder
        )
        process = virtual.process("people")
        node = VirtualNode(process, "people", stack.namespace)
        executor = VirtualExecutor(process)
        executor.add_node(node)
        components = stack.components
        observer = Observer(node, [one.node_name for one in components])
        operator = Operator(node, scenario, components, observer)
        editor = Editor(node, drive.edits, lambda: observer.now if observer.has_begun else -1.0)
        probes = Probes(node, observer)
        faults = node.create_client(SetFault, SET_FAULT)
        planner = planner_node(components)

        def on_news(news: ProcessNews) -> None:
            observer.on_news(news)
            if planner in news.nodes:
                operator.planner_changed(news.state)
            if news.name == "monitor":
                editor.monitor_changed(news.state)

        robot.on_news = on_news
        robot.start()
        scheduler = virtual.scheduler
        if not scheduler.run_while(lambda: not robot.is_up, 20 * SECOND):
            outcome.findings.append("the stack did not come up")
            return
        scheduler.run_for(nanoseconds(SETTLED))
        observer.begin()
        began = scheduler.now
        for at, conditions in drive.network:
            scheduler.call_later(nanoseconds(at), virtual.network.set_conditions, conditions)
        _chatter(node, rng, asked)
        scheduler.run_for(nanoseconds(scenario.limit))
        # The network as it was, and whoever was held goes on: a hand on STOP ends all goals.
        virtual.network.set_conditions(Conditions())
        for fault in scenario.faults:
            if fault.name.startswith(HELD_UP):
                faults.call_async(SetFault.Request(fault=fault.name, on=False))
        scheduler.run_while(lambda: not robot.is_up, nanoseconds(BACK))
        operator.act(OperatorAct(at=0.0, does="stop", by="ava", reason="the drive is over"))
        scheduler.run_for(nanoseconds(ANSWERED))
        operator.finish()
        observer.note(DriveEnded)
        facts = list(observer.facts)
        # What was acknowledged must be there after the monitor's death.
        robot.kill("monitor")
        scheduler.run_while(lambda: not (robot.is_up and editor.is_told), nanoseconds(BACK))
        editor.finish()
    outcome.facts = facts
    outcome.log = [f"{e.time / 1e9:.3f} {e.node} {e.level} {e.text}" for e in virtual.log]
    findings = outcome.findings
    findings += _broken(facts, table)
    findings += _unanswered(facts)
    findings += _unspoken(scenario, facts)
    findings += _touched(scenario, facts)
    findings += _restarts(scenario, facts, components)
    findings += _errors(scenario, virtual.log, began)
    findings += probes.findings(facts, scenario)
    findings += editor.findings()
    with RuleStore.open(folder) as store:
        findings += editor.lost_in(store)
        entries = store.journal(count=500).firings
        findings += [
            f"the journal never says what came of {each.rule_id} (run {each.run_id})"
            for each in entries
            # What the last session began may be under way yet; the probes fire in each of them.
            if each.kind == "firing" and each.ended is None and each.epoch != entries[0].epoch
        ]


def _chatter(node: VirtualNode, rng: random.Random, asked: dict[int, Any]) -> None:
    """What the random recipes look at."""
    from tests.recipe.random_recipes import KINDS, value_of

    publishers = {name: node.create_publisher(kind, name, 10) for name, kind in KINDS.items()}

    def say() -> None:
        name = rng.choice([*publishers])
        publishers[name].publish(KINDS[name](data=value_of(name, rng)))
        if asked and rng.random() < 0.1:
            rng.choice([*asked.values()])(rng.random() < 0.5)

    node.create_timer(rng.choice((0.1, 0.25)), say)


# -- what must hold ------------------------------------------------------------------------------


def _broken(facts: list[Fact], table: Table) -> Iterator[str]:
    # Whom a rule has stopped says nothing until somebody starts it.
    stopped = {
        fact.action.partition(".")[0]
        for fact in facts
        if isinstance(fact, ActionDone) and fact.action.endswith(".stop")
    }
    # What calls somebody may take as long as the drive; the journal tells its end later.
    brief = {rule.id for rule in table.rules if all(isinstance(each, Log) for each in rule.actions)}
    facts = [
        fact
        for fact in facts
        if not isinstance(fact, (RuleFired, ActionDone, RunDone)) or fact.rule_id in brief
    ]
    for at, text in firings_have_an_outcome(Course(facts), LOGGED):
        yield f"firings_have_an_outcome at {at:g} s: {text}"
    for broken in broken_invariants(facts):
        silent = broken.invariant == "nobody_is_silent_unspoken_for"
        if not (silent and broken.text.partition(" ")[0] in stopped):
            yield f"{broken.invariant} at {broken.at:g} s: {broken.text}"


def _unanswered(facts: list[Fact]) -> Iterator[str]:
    """Goals that STOP at the end of the drive has not ended, either."""
    course = Course(facts)
    for sent, ended in course.attempts:
        if ended is None and course.end - sent.at > AT_ONCE:
            yield f"the goal of {sent.at:.2f} s was never answered, though STOP was pressed"


def _unspoken(scenario: Scenario, facts: list[Fact]) -> Iterator[str]:
    """Components of a process that was gone for a while, of whom a monitor that lived said nothing.

    Sooner than the invariant asks for: in a drive this short hardly anybody is gone for long.
    """
    away = [fault.at for fault in scenario.faults if fault.name.endswith(":monitor")]
    away += [f.at for f in facts if isinstance(f, ProcessEnded) and f.process == "monitor"]
    course = Course(facts)
    for death in course.of(ProcessEnded):
        until = death.at + SPOKEN
        back = any(
            one.process == death.process and death.at <= one.at <= until
            for one in course.of(ProcessStarted)
        )
        if back or until > course.end or any(at - SPOKEN <= until for at in away):
            continue
        for component in COMPONENTS:
            told = any(
                one.component == component and one.level != HEALTHY and death.at <= one.at <= until
                for one in course.of(Status)
            )
            if component in death.components and not told:
                yield f"nobody said within {SPOKEN:g} s of {death.at:g} s that {component} was gone"


def _touched(scenario: Scenario, facts: list[Fact]) -> Iterator[str]:
    """Something, though wheels, senses and surroundings were as they should be."""
    explained = [
        fault.name
        for fault in scenario.faults
        if not fault.name.startswith(HARMLESS) or fault.name == "wrong:drive_manager"
    ]
    for contact in facts:
        if isinstance(contact, Contact) and not explained:
            yield f"the robot touched {contact.what} at {contact.at:g} s, and no fault explains it"


def _restarts(scenario: Scenario, facts: list[Fact], components: list[Any]) -> Iterator[str]:
    """Processes that died, and nobody killed or held them."""
    began = [fact for fact in facts if isinstance(fact, FaultBegan)]
    for death in facts:
        if not isinstance(death, ProcessEnded) or death.reason == "a restart was asked for":
            continue
        mine = {death.process, *death.components}
        shared = len(components) > 1 and death.process in COMPONENTS
        explained = any(
            fault.at <= death.at + 0.01
            and fault.name.startswith(("kill:", *HELD_UP))
            and (
                fault.name.partition(":")[2] in mine
                or (shared and fault.name.partition(":")[2] in COMPONENTS)
            )
            for fault in began
        )
        if not explained:
            text = f"{death.process} died at {death.at:g} s, and no fault explains it"
            yield f"{text}: {death.reason}"


def _errors(scenario: Scenario, log: list[Any], begin: int) -> Iterator[str]:
    for entry in log:
        if entry.level not in ("error", "fatal"):
            continue
        at = (entry.time - begin) / 1e9
        if OWN_MISTAKE.search(entry.text):
            yield f"{entry.node} stumbles at {at:.2f} s: {entry.text}"
        elif "failed:" in entry.text and entry.node == "monitor":
            continue  # an action of a random rule may fail; that it says so is right
        elif (
            not any(
                fault.at <= at
                and (
                    at <= fault.at + fault.duration + AFTERMATH
                    or (not fault.duration and not fault.name.startswith("kill"))
                )
                for fault in scenario.faults
            )
            and not scenario.operators
            and at <= scenario.limit  # then STOP is pressed
        ):
            yield f"{entry.node} complains at {at:.2f} s, and no fault explains it: {entry.text}"
