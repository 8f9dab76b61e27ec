"""A recipe with a mistake is refused before anything moves: file, line, field, remedy, one line."""

import re
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import pytest

GOOD = """\
from kompass import event
from kompass.actions import Action, ComponentActions, LogInfo, update_parameter
from kompass.components import Controller, DriveManager, LocalMapper, Planner, PlannerConfig
from kompass.robot import AngularCtrlLimits, LinearCtrlLimits, RobotConfig
from kompass.ros import Event, Launcher, Topic

planner, driver, mapper = Planner(), DriveManager(), LocalMapper()
number = Topic(name="/number", msg_type="Float64")
events = {}
launcher = Launcher()
MISTAKE
launcher.kompass(components=[planner, driver, mapper], events_actions=events)
launcher.bringup()
"""
LINE = GOOD.splitlines().index("MISTAKE") + 1
BRINGUP = LINE + 2


SHAPE = "geometry_type='CYLINDER', geometry_params"
LIMITS = (
    "ctrl_vx_limits=LinearCtrlLimits(max_vel=1.0), ctrl_omega_limits=AngularCtrlLimits(max_vel=1.0)"
)


class Mistake(NamedTuple):
    """A line of a recipe, where it is told of, and what must be said."""

    text: str
    said: str
    line: int = LINE


MISTAKES = {
    "unknown attribute": Mistake(
        "planner.status_topic.msg.statuss == 1",
        r"ComponentStatus has no field 'statuss'; did you mean 'status'\?",
    ),
    "a method that a launcher does not have": Mistake(
        "launcher.bring_up()", r"object has no attribute 'bring_up'; did you mean 'bringup'\?"
    ),
    "one topic of two types": Mistake(
        "planner.inputs(goal_point=[Topic(name='/to', msg_type='PoseStamped'), "
        "Topic(name='/to', msg_type='PointStamped')])",
        r"/to is a PoseStamped for planner: goal_point, and a PointStamped for planner: goal_point",
        BRINGUP,
    ),
    "a name that ROS does not take": Mistake(
        "Planner(component_name='pl\u00e4nner 2')",
        r"Planner: component_name = 'pl\u00e4nner 2' is no name of a ROS node; give letters",
    ),
    "a name that is no text": Mistake(
        "Planner(component_name=5)", r"Planner: component_name = 5 is no name of a ROS node; give"
    ),
    "a type that is neither class nor name": Mistake(
        "Topic(name='/a', msg_type=5)", r"msg_type = 5 is no type; give its class or its name"
    ),
    "a configuration that is no path": Mistake(
        "Planner(config_file=5)", r"config_file = 5 is no path; give that of a yaml, toml or json"
    ),
    "what is opened by no name": Mistake(
        "launcher.open_to_rules(topics=['a b'])", r"topics holds 'a b': topic name 'a b' is not va"
    ),
    "the monitor's name": Mistake(
        "planner = Planner(component_name='monitor')",
        r"component_name = 'monitor' is the name of the node that runs the rules; choose another",
        LINE + 1,
    ),
    "wrong type": Mistake(
        "Event(number.msg.data == 'high')", r"/number data == 'high': it is a number, and .* text"
    ),
    "bounds the wrong way round": Mistake(
        "Event(number.msg.data.between(0.4, 0.2))",
        r"/number data between \(0\.4, 0\.2\): give the lower number first",
    ),
    "unknown message type": Mistake(
        "Topic(name='/scan', msg_type='LaserScann')", r"msg_type = 'LaserScann': no such message"
    ),
    "unknown attribute of an older event": Mistake(
        "event.OnEqual('e', number, 1.0, ['dta'])", r"no field 'dta'; did you mean 'data'\?"
    ),
    "missing component method": Mistake(
        "Action(driver.move_to_unblok)", r"no attribute 'move_to_unblok'"
    ),
    "method that rules may not call": Mistake(
        "Action(driver.publish_status)", r"drive_manager\.publish_status cannot be called by a rule"
    ),
    "wrong arguments": Mistake(
        "Action(driver.move_forward, kwargs={'distance': 1.0})",
        r"move_forward\(max_distance: 'float'\).* does not take|move_forward\(.*does not take",
    ),
    "missing argument": Mistake(
        "events[Event(number)] = Action(driver.move_forward)",
        r"lacks max_distance; give it with args or kwargs",
        BRINGUP,
    ),
    "unknown parameter": Mistake(
        "update_parameter(component=driver, param_name='scan_timeot', new_value=1.0)",
        r"'scan_timeot' is not a setting of DriveManagerConfig; did you mean 'scan_timeout'\?",
    ),
    "parameter out of range": Mistake(
        "update_parameter(component=driver, param_name='scan_timeout', new_value=-1.0)",
        r"'scan_timeout' = -1\.0: .*greater than",
    ),
    "setting out of range": Mistake("PlannerConfig(loop_rate=-1.0)", r"loop_rate = -1\.0: .*great"),
    "mistyped setting": Mistake("PlannerConfig(loop_rat=1.0)", r"loop_rat"),
    "mistyped field of a robot": Mistake(
        f"RobotConfig(modl_type='OMNI', {SHAPE}=[0.1, 0.2], {LIMITS})",
        r"ValidationError: modl_type = 'OMNI': is not a setting of RobotConfig; .*'model_type'\?$",
    ),
    "numbers of a shape": Mistake(
        f"RobotConfig(model_type='OMNI', {SHAPE}=[0.1, 0.2, 0.3], {LIMITS})",
        r"ValidationError: RobotConfig does not fit: geometry_params of a CYLINDER are 2 numbers",
    ),
    "config of another class": Mistake(
        "Controller(config=PlannerConfig())",
        r"TypeError: controller: config, a PlannerConfig, is not a ControllerConfig$",
    ),
    "mistyped attribute": Mistake(
        "driver.loop_rat = 5.0", r"AttributeError: drive_manager: .*did you mean 'loop_rate'\?$"
    ),
    "value that is never there": Mistake(
        "planner.status_topic.msg.status == 300", r"/planner/status status == 300: .*0 to 255"
    ),
    "duplicate id": Mistake(
        "events.update({event.OnAny('same', number): LogInfo(msg='a'), "
        "event.OnAny('same', mapper.status_topic): LogInfo(msg='b')})",
        r"two events are called 'same'; names must differ",
        BRINGUP,
    ),
    "duplicate component": Mistake(
        "launcher.kompass(components=[Planner(), Planner()])",
        r"two components are called 'planner'; names must differ",
    ),
    "missing configuration": Mistake(
        "Planner(config_file='nowhere.yaml')", r"nowhere\.yaml: there is no such configuration file"
    ),
    "unreadable configuration": Mistake(
        "Planner(config_file=__file__)", r"a configuration file ends in \.yaml, \.yml"
    ),
    "action of a component that is not there": Mistake(
        "events[Event(number)] = Action(Controller().restart)",
        r"'controller' is not among the components of the launcher; those are planner, drive_man",
        BRINGUP,
    ),
    "no event": Mistake(
        "events['battery low'] = LogInfo(msg='x')", r"'battery low' is not an event", BRINGUP
    ),
    "no action": Mistake("events[Event(number)] = print", r"is not an action", BRINGUP),
    "python's own and": Mistake(
        "Event((number.msg.data > 1) and (number.msg.data < 2))", r"combine conditions with & \| ~"
    ),
}


# The command itself, forked from an interpreter that has imported all: a second each is saved.
FORKER = """
import os, sys, traceback
import kompass_console.cli, kompass_console.stack, kompass.ros, kompass.actions
for recipe in sys.argv[1:]:
    pid = os.fork()
    if pid == 0:
        said = os.open(recipe + ".said", os.O_WRONLY | os.O_CREAT)
        os.dup2(said, 1), os.dup2(said, 2)
        sys.argv = ["kompass-console", "run", recipe, "--no-browser", "--port", "0"]
        code = 0
        try:
            kompass_console.cli.main()
        except SystemExit as ended:
            code = ended.code
        except BaseException:
            traceback.print_exc()
            code = 99
        sys.stdout.flush(), sys.stderr.flush()
        os._exit(code)
    _, status = os.waitpid(pid, 0)
    print(os.waitstatus_to_exitcode(status), flush=True)
"""


def run(*recipes: Path) -> tuple[list[int], list[str]]:
    """Exit codes and words of recipes."""
    ran = subprocess.run(
        [sys.executable, "-c", FORKER, *map(str, recipes)],
        capture_output=True,
        text=True,
        timeout=100,
        check=True,
    )
    return [int(code) for code in ran.stdout.split()], [
        Path(f"{recipe}.said").read_text() for recipe in recipes
    ]


@pytest.fixture(scope="module")
def refused(tmp_path_factory: pytest.TempPathFactory) -> dict[str, tuple[int, str]]:
    """The exit code and the words of each bad recipe."""
    folder = tmp_path_factory.mktemp("bad")
    recipes = []
    for number, mistake in enumerate(MISTAKES.values()):
        recipes.append(folder / f"bad_{number}.py")
        recipes[-1].write_text(GOOD.replace("MISTAKE", mistake.text))
    return dict(zip(MISTAKES, zip(*run(*recipes), strict=True), strict=True))


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_is_told_in_one_line(refused: dict[str, tuple[int, str]], name: str) -> None:
    (code, output), mistake = refused[name], MISTAKES[name]
    assert code == 3, output
    said = output.splitlines()
    assert len(said) == 1, "nor the address of a console that does not come up"
    assert re.search(rf"bad_\d+\.py:{mistake.line}: \w+: ", said[0]), said[0]
    assert re.search(mistake.said, said[0]), said[0]


def test_a_recipe_that_brings_nothing_up_does_not_end_as_if_all_were_well(tmp_path: Path) -> None:
    recipe = tmp_path / "no_bringup.py"
    recipe.write_text(GOOD.replace("MISTAKE", "").replace("launcher.bringup()", ""))
    (code,), (said,) = run(recipe)
    assert code == 3, said
    assert "no_bringup.py: it ended without a stack; call launcher.bringup() at its end" in said
