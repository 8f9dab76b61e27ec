"""A recipe drives in virtual time: its components, its rules, the supervisor's policy."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from kompass.drills.facts import (
    Motion,
    ProcessEnded,
    ProcessStarted,
    RuleFired,
    Status,
    StopPressed,
    in_order,
)
from kompass.drills.runner.observer import Observer
from kompass.drills.runner.operator import NoPlanner
from kompass.drills.runner.run import Observed, run_drive
from kompass.drills.runner.worker import stack_of
from kompass.drills.scenario import Goal, OperatorAct, Scenario, ScheduledFault, Start
from kompass.rules.schema.table import Table
from kompass.supervisor.news import ProcessNews
from kompass.virtual.executor import VirtualExecutor
from kompass.virtual.node import VirtualNode
from kompass.virtual.process import World
from kompass.virtual.scheduler import SECOND

RECIPES = Path(__file__).parents[2] / "recipes"
GUARDED = RECIPES / "03_events_and_actions.py"


WITHOUT_PLANNER = """\
from kompass.components import LocalMapper
from kompass.launcher import Launcher

launcher = Launcher()
launcher.kompass(components=[LocalMapper("mapper")])
launcher.bringup()
"""


TAKES_GOALS = """\
from kompass.components import Controller, DriveManager, LocalMapper, Planner, PlannerConfig
from kompass.launcher import Launcher
from kompass.ros import Topic
from tests.support.turtlebot import turtlebot

planner = Planner("planner", config=PlannerConfig(goals_from_topics=True))
planner.run_type = "ActionServer"
planner.inputs(goal_point=Topic(name="/goals", msg_type="{kind}"))
launcher = Launcher()
launcher.kompass(
    components=[
        planner, Controller("controller"), LocalMapper("mapper"), DriveManager("drive_manager")
    ]
)
launcher.robot = turtlebot()
launcher.inputs(location=Topic(name="/odometry/filtered", msg_type="Odometry"))
launcher.bringup()
"""


def scenario(*faults: ScheduledFault, **more: object) -> Scenario:
    given: dict[str, object] = {
        "name": "test",
        "world": "hexagon",
        "seed": 4,
        "start": Start(x=-2.0, y=-0.5),
        "goals": (Goal(x=0.7, y=-0.5, at=2.0),),
        "faults": faults,
        "limit": 90.0,
    }
    return Scenario.model_validate({**given, **more})


def drive(one: Scenario, recipe: Path = GUARDED, table: Table | None = None) -> Observed:
    with TemporaryDirectory() as folder, pytest.MonkeyPatch.context() as patch:
        patch.setenv("KOMPASS_DATA_DIR", folder)  # as each process of a drill has one
        return run_drive(stack_of(recipe), one, table)


def test_a_robot_arrives_faster_than_it_drives() -> None:
    observed = drive(scenario())
    assert observed.result.outcome == "arrived"
    last = [fact for fact in observed.facts if isinstance(fact, Motion)][-1]
    assert (last.x, last.y) == pytest.approx((0.7, -0.5), abs=0.12)
    assert observed.result.contacts == ()
    assert observed.result.broken == ()


@pytest.mark.parametrize("seed", [1, 4])
def test_a_robot_passes_a_pillar_by_its_local_map_without_turning_to_and_fro(seed: int) -> None:
    beside = {"start": Start(x=0.675, y=-1.625), "goals": (Goal(x=1.225, y=0.525),)}
    observed = drive(scenario(seed=seed, **beside), RECIPES / "04_cross_component_healing.py")
    assert observed.result.outcome == "arrived", observed.result.why
    assert observed.result.duration < 25.0  # 15 s are what it takes to be given up


KILLED = ScheduledFault(name="kill:mapper", at=6.0)


@pytest.fixture(scope="module")
def killed() -> Observed:
    """A drive in which the mapper is killed."""
    return drive(scenario(KILLED))


def test_the_same_seed_gives_the_same_facts_and_another_one_others(killed: Observed) -> None:
    assert drive(scenario(KILLED)).facts == killed.facts
    assert drive(scenario(KILLED, seed=5)).facts != killed.facts


def test_a_killed_process_is_started_again_by_the_policy_of_the_supervisor(
    killed: Observed,
) -> None:
    (death,) = (fact for fact in killed.facts if isinstance(fact, ProcessEnded))
    (life,) = (fact for fact in killed.facts if isinstance(fact, ProcessStarted))
    assert death.process == life.process == "mapper"
    assert 0.1 < life.at - death.at < 1.5  # its first delay is 0.1 s
    assert killed.result.outcome == "recovered"


def test_a_stopped_process_is_killed_when_patience_ends_and_started_again() -> None:
    observed = drive(scenario(ScheduledFault(name="stop:mapper", at=6.0, duration=60.0)))
    reasons = [fact.reason for fact in observed.facts if isinstance(fact, ProcessEnded)]
    assert reasons[0] == "the process was stopped by a signal"
    assert reasons[1] == "it was stuck for 3 s"
    assert observed.result.outcome == "recovered"


def test_a_person_stops_the_robot_and_it_stays_stopped() -> None:
    press = OperatorAct(at=6.0, does="stop", by="ava", reason="somebody stands there")
    observed = drive(scenario(operators=(press,)))
    assert observed.result.outcome == "stopped"
    moved = [
        fact
        for fact in observed.facts
        if isinstance(fact, Motion) and fact.at > 6.5 and fact.speed > 0.02
    ]
    assert moved == []


def test_a_released_robot_takes_the_next_goal() -> None:
    acts = (
        OperatorAct(at=6.0, does="stop", by="ava"),
        OperatorAct(at=9.0, does="release", by="ava"),
    )
    goals = (Goal(x=0.7, y=-0.5, at=2.0), Goal(x=0.0, y=-0.5, at=10.0))
    result = drive(scenario(operators=acts, goals=goals)).result
    assert [goal.outcome for goal in result.goals] == ["stopped", "arrived"]


def test_the_table_that_is_given_is_in_force_instead_of_the_recipes() -> None:
    blocked = ScheduledFault(name="boxed_in", at=6.0, duration=40.0)
    own = drive(scenario(blocked))
    none = drive(scenario(blocked), table=Table(rules=()))
    assert any(isinstance(fact, RuleFired) for fact in own.facts)
    assert not any(isinstance(fact, RuleFired) for fact in none.facts)


def test_what_fires_while_the_stack_settles_counts_as_of_the_beginning() -> None:
    heard = {"kind": "received", "signal": {"topic": "scan", "type": "sensor_msgs/msg/LaserScan"}}
    rule = {
        "id": "at-once",
        "event": {"condition": heard, "cooldown": 3600.0},
        "actions": [{"kind": "log", "text": "!"}],
    }
    result = drive(scenario(limit=3.0), table=Table.model_validate({"rules": [rule]})).result
    (firing,) = result.firings
    assert (firing.rule_id, firing.at, firing.ok) == ("at-once", 0.0, True)


def test_what_was_seen_before_the_beginning_counts_as_of_then_in_its_order() -> None:
    with World(1) as world:
        node = VirtualNode(world.process("people"), "people")
        executor = VirtualExecutor(node.process)
        executor.add_node(node)
        observer = Observer(node, ["mapper"])
        observer.note(Status, "mapper", 1, "coming up")
        observer.on_news(ProcessNews("mapper", ["mapper"], "dead", reason="killed"))
        observer.note(StopPressed, "rule x")
        observer.on_news(ProcessNews("mapper", ["mapper"], "active"))
        observer.note(Status, "mapper", 0)
        world.scheduler.run_for(SECOND)
        observer.begin()
    assert all(fact.at < 0.001 for fact in observer.facts)
    kinds = [type(fact) for fact in in_order(observer.facts)]
    assert kinds == [ProcessEnded, StopPressed, ProcessStarted, Status]


def test_a_goal_that_is_due_while_the_planner_is_dead_is_sent_when_it_is_back() -> None:
    faults = (ScheduledFault(name="kill:planner", at=1.9),)
    goals = (Goal(x=0.7, y=-0.5, at=2.0),)
    observed = drive(scenario(*faults, goals=goals, limit=60.0))
    (back,) = (fact.at for fact in observed.facts if isinstance(fact, ProcessStarted))
    (goal,) = observed.result.goals
    assert back <= goal.sent < back + 2.0
    assert goal.outcome == "arrived"


def test_goals_that_a_held_planner_never_took_over_end_with_its_death() -> None:
    faults = (ScheduledFault(name="stop:planner", at=1.5),)
    goals = (Goal(x=0.7, y=-0.5, at=1.0), Goal(x=-0.7, y=-0.5, at=2.0))
    results = drive(scenario(*faults, goals=goals, limit=8.0)).result.goals
    assert [(goal.outcome, goal.message) for goal in results] == [
        ("error", "the planner's process died")
    ] * 2


def test_a_fault_that_is_refused_is_told_with_the_reason() -> None:
    faults = (
        ScheduledFault(name="kill:mapper", at=1.0),
        ScheduledFault(name="stop:mapper", at=1.05),
        ScheduledFault(name="hang:mapper", at=1.25),
        ScheduledFault(name="wrong:monitor", at=1.0),
    )
    result = drive(scenario(*faults, limit=4.0)).result
    assert [fault.name for fault in result.faults] == ["kill:mapper"]
    assert result.broken == ()
    reasons = {fault.name: fault.reason for fault in result.refused}
    assert reasons["stop:mapper"].startswith("mapper is dead, and cannot be stopped")
    assert reasons["hang:mapper"].startswith("mapper is starting, and cannot be hung up")
    assert reasons["wrong:monitor"].startswith("monitor says nothing that others drive by")


# 03 and 04 arrive in tests above; 05 and later ones are drilled in test_recorded.py.
@pytest.mark.parametrize("recipe", ["01_point_navigation.py", "02_self_healing.py"])
def test_recipes_that_no_other_test_drills_drive(recipe: str) -> None:
    assert drive(scenario(), RECIPES / recipe).result.outcome == "arrived"


@pytest.mark.parametrize("kind", ["PoseStamped", "PointStamped", "Odometry"])
def test_a_goal_is_published_as_whatever_the_planner_takes_goals_as(
    kind: str, tmp_path: Path
) -> None:
    recipe = tmp_path / "takes.py"
    recipe.write_text(TAKES_GOALS.format(kind=kind), encoding="utf-8")
    goal = Goal(x=-1.2, y=-0.5, at=2.0, topic="/goals")
    assert drive(scenario(goals=(goal,)), recipe).result.outcome == "arrived"


def test_a_recipe_without_a_planner_is_refused_with_the_remedy(tmp_path: Path) -> None:
    recipe = tmp_path / "halting.py"
    recipe.write_text(WITHOUT_PLANNER, encoding="utf-8")
    with pytest.raises(NoPlanner, match="a drill needs a Planner"):
        drive(scenario(), recipe)
