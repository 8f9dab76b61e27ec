"""One drive, from a stack and a scenario to the facts."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path

from kompass.drills.drive import DriveResult
from kompass.drills.facts import DriveEnded, Fact
from kompass.drills.judge import judge
from kompass.drills.runner.observer import Observer
from kompass.drills.runner.operator import Operator, planner_node
from kompass.drills.runner.recording import DriveRecording
from kompass.drills.scenario import Scenario
from kompass.launch.stack import Stack
from kompass.launch.virtual_stack import USUAL, Embedded, VirtualStack
from kompass.recorder.topics import standard_topics
from kompass.rules.schema.table import Table
from kompass.simulation.physics.robot_model import robot_model
from kompass.simulation.worlds.registry import world
from kompass.supervisor.news import ProcessNews
from kompass.virtual.executor import VirtualExecutor
from kompass.virtual.network import Conditions
from kompass.virtual.node import VirtualNode
from kompass.virtual.process import World
from kompass.virtual.scheduler import SECOND, nanoseconds

BRINGUP = 20 * SECOND  # ns in which a stack must be up
DISCOVERY = 0.1  # s in which DDS finds what is new on a machine that has the time for it
SETTLED = 2.0  # s between the bring-up and the beginning of the drive
AFTERWARDS = 3.0  # s that are looked at after the last goal has ended
STEP = SECOND // 4  # ns between two looks at whether it is over
PEOPLE = "people"


class NotUp(RuntimeError):
    """The stack did not come up."""


@dataclass(frozen=True)
class Observed:
    """A drive as it was observed, and judged."""

    facts: tuple[Fact, ...]
    result: DriveResult
    log: tuple[str, ...]


def run_drive(
    stack: Stack,
    scenario: Scenario,
    table: Table | None = None,
    recording: Path | None = None,
    embedded: Embedded = USUAL,
) -> Observed:
    """Let one drive happen.

    Parameters
    ----------
    stack
        Fresh from the recipe: it is used up.
    scenario
        What is to happen.
    table
        The rules in force; those of the recipe when left out.
    recording
        File to write the drive to, as the flight recorder does; nothing when left out. The drive
        goes the same way.
    embedded
        The robot's map; which robot it is, the scenario says.

    Raises
    ------
    NotUp
        When the stack does not come up.
    NoPlanner
        When nobody takes goals.
    OSError
        When the recording exists, or cannot be written.
    """
    with World(scenario.seed, discovery=DISCOVERY) as virtual:
        process = virtual.process(PEOPLE)
        # Whatever breaks on the robot's machine, they see and ask as ever.
        virtual.network.set_conditions(Conditions(), process=PEOPLE)
        node = VirtualNode(process, PEOPLE, stack.namespace)
        recorded = None
        if recording is not None:
            topics = standard_topics(stack.components)
            recorded = DriveRecording(recording, virtual.scheduler, topics, node.resolve_topic_name)
            virtual.network.ear = recorded.sent
        try:
            return _drive(virtual, node, stack, scenario, table, recorded, embedded)
        finally:
            if recorded is not None:
                recorded.abandon()


def _drive(
    virtual: World,
    node: VirtualNode,
    stack: Stack,
    scenario: Scenario,
    table: Table | None,
    recorded: DriveRecording | None,
    embedded: Embedded,
) -> Observed:
    process, components = node.process, stack.components
    place = world(scenario.world)
    if scenario.start is not None:
        place = replace(place, start=scenario.first_pose)
    names = [component.node_name for component in components]
    planner = planner_node(components)
    robot = VirtualStack(
        *(virtual, stack, place),
        seed=scenario.seed,
        table=table,
        recording=recorded,
        embedded=replace(embedded, kind=robot_model(scenario.robot)),
    )
    executor = VirtualExecutor(process)
    executor.add_node(node)
    observer = Observer(node, names)
    operator = Operator(node, scenario, components, observer)

    def on_news(news: ProcessNews) -> None:
        observer.on_news(news)
        if planner in news.nodes:
            operator.planner_changed(news.state)

    robot.on_news = on_news
    with closing(robot):
        robot.start()
        scheduler = virtual.scheduler
        if not scheduler.run_while(lambda: not robot.is_up, BRINGUP):
            raise NotUp("the stack did not come up")
        scheduler.run_for(nanoseconds(SETTLED))
        observer.begin()
        if recorded is not None:
            recorded.begins(scenario)
        _run_while(
            scheduler.run_for, lambda: not operator.is_done, scenario.limit, lambda: observer.now
        )
        left = min(AFTERWARDS, scenario.limit - observer.now)
        if left > 0.0:
            scheduler.run_for(nanoseconds(left))
        operator.finish()
        observer.note(DriveEnded)
        if recorded is not None:
            recorded.finish()
    facts = tuple(observer.facts)
    log = tuple(f"{entry.time} {entry.node} {entry.level} {entry.text}" for entry in virtual.log)
    return Observed(facts, judge(scenario, facts), log)


def _run_while(
    run_for: Callable[[int], None],
    goes_on: Callable[[], bool],
    limit: float,
    now: Callable[[], float],
) -> None:
    while goes_on() and now() < limit:
        run_for(min(STEP, max(1, nanoseconds(limit - now()))))
