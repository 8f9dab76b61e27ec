"""The launcher takes what recipes of every generation ask of it."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from kompass.components import Controller, DriveManager, LocalMapper, Planner
from kompass.components.base.config_file import ConfigFileError
from kompass.launch.companions import companions
from kompass.launch.stack import Stack, stacks_go_to
from kompass.launcher import Launcher
from kompass.rclpy_ext.topic import Topic
from kompass.recipe.table import recipe_rules
from kompass.robot import RobotFrames
from kompass.supervisor.process import ProcessSpec
from tests.support.described import described_robot


def stack_of(launcher: Launcher) -> Stack:
    """What the launcher brings up."""
    given: list[Stack] = []
    with stacks_go_to(given.append):
        launcher.bringup()
    (stack,) = given
    return stack


def processes(launcher: Launcher) -> list[list[str]]:
    """Names of the nodes in each process of the components."""
    return [[one.node_name for one in group] for group in stack_of(launcher).groups]


@pytest.mark.parametrize("keyword", ["multi_processing", "multiprocessing"])
@pytest.mark.parametrize("flag", [True, False])
def test_both_spellings_choose_processes_or_threads(keyword: str, flag: bool) -> None:
    launcher = Launcher()
    chosen: Any = {keyword: flag}
    launcher.kompass([Planner(), DriveManager()], **chosen)
    apart = [["planner"], ["drive_manager"]]
    assert processes(launcher) == (apart if flag else [["planner", "drive_manager"]])


def test_the_launcher_itself_may_say_how_to_run() -> None:
    launcher = Launcher(multi_processing=False, activate_all_components_on_start=False)
    launcher.kompass([Planner(), DriveManager()])
    assert processes(launcher) == [["planner", "drive_manager"]]
    assert launcher._activate == []


@pytest.mark.parametrize(("override", "count"), [("0", 1), ("1", 2)])
def test_the_environment_overrides_the_recipe(
    monkeypatch: pytest.MonkeyPatch, override: str, count: int
) -> None:
    monkeypatch.setenv("KOMPASS_MULTI_PROCESSING", override)
    launcher = Launcher()
    launcher.kompass([Planner(), DriveManager()], multi_processing=override == "0")
    assert len(processes(launcher)) == count


def test_another_override_names_the_two(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("KOMPASS_MULTI_PROCESSING", "yes")
    with pytest.raises(ValueError, match="'yes' is neither 0 nor 1"):
        Launcher().kompass([Planner()])


def test_packages_are_added_with_threads_unless_told_otherwise() -> None:
    launcher = Launcher()
    launcher.add_pkg([Planner(), DriveManager()], package_name="kompass")
    launcher.add_pkg(
        components=[LocalMapper()], package_name="kompass", multiprocessing=True, events_actions={}
    )
    assert sorted(processes(launcher), key=len) == [["mapper"], ["planner", "drive_manager"]]


def test_agents_are_components_too() -> None:
    launcher = Launcher()
    launcher.agents([Planner()], {}, True, False)
    assert launcher._activate == []
    assert [component.node_name for component in launcher.components] == ["planner"]


def test_only_the_chosen_components_become_active() -> None:
    planner, driver = Planner(), DriveManager()
    launcher = Launcher()
    launcher.kompass([planner, driver], components_to_activate_on_start=[driver])
    assert launcher._activate == ["drive_manager"]


def test_a_general_fallback_is_for_all_that_have_none_of_their_own() -> None:
    planner, driver = Planner(), DriveManager()
    driver.on_fail(driver.move_to_unblock)
    launcher = Launcher()
    launcher.kompass([planner, driver])
    launcher.on_fail(action_name="restart", max_retries=2)
    launcher._failure_policies.apply(launcher.components)
    assert planner.fallbacks.on_fail is not None
    assert planner.fallbacks.on_fail.actions == (planner.restart,)
    assert planner.fallbacks.on_fail.max_retries == 2
    assert driver.fallbacks.on_fail is not None
    assert driver.fallbacks.on_fail.actions == (driver.move_to_unblock,)


@pytest.mark.parametrize(
    "kind", ["on_algorithm_fail", "on_component_fail", "on_system_fail", "on_giveup"]
)
def test_each_kind_of_failure_has_a_general_fallback(kind: str) -> None:
    planner = Planner()
    launcher = Launcher()
    launcher.kompass([planner])
    getattr(launcher, kind)(action_name="restart")
    launcher._failure_policies.apply(launcher.components)
    assert getattr(planner.fallbacks, kind) is not None


def test_a_general_fallback_that_nobody_has_is_refused() -> None:
    launcher = Launcher()
    launcher.kompass([Planner()])
    with pytest.raises(ValueError, match=r"no component has an action 'restrat'; known are .*rest"):
        launcher.on_fail(action_name="restrat")


def test_the_fallback_rate_is_the_pause_between_two_tries() -> None:
    driver = DriveManager()
    driver.on_fail(driver.restart)
    launcher = Launcher()
    launcher.kompass([driver])
    launcher.fallback_rate = 1 / 10
    assert launcher.fallback_rate == {"drive_manager": 0.1}
    rules = recipe_rules({}, [driver]).table.rules
    assert rules[0].event.cooldown == pytest.approx(10.0)


@pytest.mark.parametrize("given", [0, -1, 1.5, True])
def test_tries_of_processes_are_counted_in_whole_numbers(given: Any) -> None:
    with pytest.raises(ValueError, match=r"on_process_fail: max_retries"):
        Launcher().on_process_fail(max_retries=given)


def test_one_component_may_be_configured_apart(tmp_path: Path) -> None:
    path = tmp_path / "robot.yaml"
    path.write_text("/**: {loop_rate: 3.0}\n")
    planner, driver = Planner(), DriveManager()
    launcher = Launcher()
    launcher.kompass([planner, driver])
    launcher.configure(str(path), component_name="planner")
    assert planner.config.loop_rate == 3.0
    assert driver.config.loop_rate != 3.0
    with pytest.raises(ValueError, match="no component 'planer'; there are planner, drive_manager"):
        launcher.configure(str(path), component_name="planer")


def test_frames_and_log_levels_reach_all() -> None:
    planner, controller = Planner(), Controller()
    launcher = Launcher()
    launcher.kompass([planner, controller], rclpy_log_level="error")
    launcher.frames = RobotFrames(world="world", scan="LDS-01", rgb="camera")
    assert {frames.world for frames in launcher.frames.values()} == {"world"}
    assert controller.config.rclpy_log_level == "error"


def test_programs_and_functions_run_beside_the_components(tmp_path: Path) -> None:
    program = tmp_path / "battery.py"
    program.write_text("print('charging')\n")
    done: list[tuple[int, str]] = []

    def once(number: int, text: str) -> None:
        done.append((number, text))

    launcher = Launcher()
    before = len(companions())
    try:
        launcher.add_py_executable(str(program))
        launcher.add_method(once, args=(1,), kwargs={"text": "a"})
        added: list[ProcessSpec] = companions()[before:]
        assert [(spec.name, spec.restart) for spec in added] == [("battery", True), ("once", False)]
        added[1].main(lambda line: None)
        assert done == [(1, "a")]
    finally:
        del launcher_companions()[before:]
    with pytest.raises(FileNotFoundError, match=r"nowhere\.py"):
        launcher.add_py_executable("nowhere.py")


def launcher_companions() -> list[ProcessSpec]:
    from kompass.launch import companions as module

    return module._companions


def test_words_without_meaning_here_are_accepted() -> None:
    launcher = Launcher(enable_monitoring=True, activation_timeout=5.0)
    planner = Planner(enable_health_broadcast=True)
    launcher.kompass([planner], ros_log_level="warn")
    launcher.enable_ui(inputs=[planner.ui_main_action_input], outputs=[], port=5001)
    launcher.setup_launch_description()
    with pytest.raises(ValueError, match="robot_plugin"):
        Launcher(robot_plugin=object())


def test_a_long_plan_is_given_its_time() -> None:
    from kompass.components import PlannerConfig

    launcher = Launcher()
    launcher.kompass([Planner(config=PlannerConfig(planning_timeout=30.0))])
    (planner,) = stack_of(launcher).components
    assert planner.longest_step > 30.0


# Every name that a recipe of some generation may call, read or set.
PUBLIC = {
    *(
        "activation_timeout",
        "config_file",
        "enable_monitoring",
        "namespace",
        "patience",
        "recovery",
    ),
    *("kompass", "agents", "add_pkg", "components", "robot", "frames", "masks"),
    "configure",
    *("inputs", "outputs", "on", "bringup", "setup_launch_description", "enable_ui"),
    *("fallback_rate", "on_fail", "on_algorithm_fail", "on_component_fail", "on_system_fail"),
    *("on_giveup", "on_process_fail", "add_py_executable", "add_method", "open_to_rules"),
}


def test_recipes_find_all_that_they_may_ask_for_and_nothing_else() -> None:
    assert {name for name in dir(Launcher()) if not name.startswith("_")} == PUBLIC


PLUGIN: Any = {"use_plugin": True}


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("namespace", "a b", "namespace = 'a b' is none in ROS"),
        ("namespace", 5, "namespace = 5 is none in ROS"),
        ("activation_timeout", "x", "activation_timeout = 'x': give seconds above 0"),
        ("activation_timeout", True, "activation_timeout = True: give seconds above 0"),
    ],
)
def test_what_is_set_later_is_looked_at_as_what_is_given_first(
    name: str, value: Any, said: str
) -> None:
    launcher = Launcher()
    with pytest.raises(ValueError, match=said):
        setattr(launcher, name, value)
    with pytest.raises(ValueError, match=said):
        Launcher(**{name: value})


NO_PATH: Any = math.nan
MISTYPED: Any = {"name_space": "robot1"}


# -- every argument does what it says, or is refused with a sentence -----------------------------


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda it: it.kompass([Planner()], multiprocesing=True),
            r"Launcher\.kompass\(\) has no argument 'multiprocesing'; did you mean 'multiproc",
        ),
        (lambda it: it.add_pkg([Planner()], package="kompass"), "did you mean 'package_name'"),
        (lambda it: it.bringup(configfile="x"), "did you mean 'config_file'"),
        (lambda _: Planner(confg=None), r"has no argument 'confg'; did you mean 'config'"),
        (
            lambda _: Topic(name="a", msg_type="Bool", **PLUGIN),
            r"Topic\(\) has no argument 'use_plugin'; known are name, msg_type",
        ),
        (lambda _: Launcher(**MISTYPED), "did you mean 'namespace'"),
        (lambda it: it.kompass([Planner()], xyz=1), "has no argument 'xyz'; known are components"),
        (lambda it: it.kompass(Planner()), r"components = .* is a component; give a list, \[plann"),
        (lambda it: it.kompass(3), "components = 3 is no list"),
        (lambda it: it.kompass(["planner"]), "components holds 'planner', which is not"),
        (lambda it: it.kompass([Planner()], [1]), r"events_actions = \[1\] is no mapping"),
        (
            lambda it: it.kompass([Planner()], multi_processing="no"),
            "multi_processing = 'no' is nei",
        ),
        (
            lambda it: it.kompass([Planner()], components_to_activate_on_start=Planner("other")),
            "components_to_activate_on_start = .* is a component; give a list",
        ),
        (
            lambda it: setattr(it, "robot", {"radius": 1}),
            r"launcher\.robot = .* give a RobotConfig",
        ),
        (
            lambda it: setattr(it, "robt", {"radius": 1}),
            "a Launcher has no attribute 'robt'; did you mean 'robot'",
        ),
        (lambda _: Launcher(config_file=NO_PATH), "config_file = nan is no path"),
        (lambda it: setattr(it, "config_file", 5), "config_file = 5 is no path"),
        (lambda _: Launcher(enable_monitoring=NO_PATH), "enable_monitoring = nan is neither"),
        (lambda it: setattr(it, "enable_monitoring", "no"), "enable_monitoring = 'no' is neither"),
        (
            lambda it: it.kompass([Planner()], activate_all_components_on_start="no"),
            "activate_all_components_on_start = 'no' is neither",
        ),
        (lambda it: setattr(it, "patience", 5), r"patience = 5 are no limits; give Liveness"),
        (lambda it: setattr(it, "inputs", 5), r"launcher.inputs is to be called"),
        (lambda it: setattr(it, "frames", "map"), r"launcher\.frames = 'map' are no frames"),
        (lambda it: setattr(it, "masks", "stairs.yaml"), r"launcher\.masks = 'stairs.yaml' are no"),
        (lambda it: it.open_to_rules(topics=5), "topics = 5 is no list; give one of names"),
        (lambda it: it.open_to_rules(actions="dock"), "actions = 'dock' is no list"),
    ],
)
def test_an_argument_of_a_wrong_kind_is_refused(call: Callable[[Any], Any], message: str) -> None:
    launcher = Launcher()
    with pytest.raises((TypeError, AttributeError), match=message):
        call(launcher)
    assert launcher.components == []


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda it: it.kompass([Planner()], multi_processing=True, multiprocessing=False),
            "multi_processing = True and multiprocessing = False are one thing",
        ),
        (
            lambda it: it.kompass([Planner()], components_to_activate_on_start=[Controller()]),
            "holds 'controller', which is not among the components",
        ),
        (lambda it: it.kompass([DriveManager(), Planner(), Planner()]), "two components"),
        (
            lambda it: it.kompass([Planner(), Controller()], ros_log_level="loud"),
            "planner: 'log_level' = 'loud'",
        ),
        (
            lambda it: it.kompass([Planner()], rclpy_log_level="loud"),
            "planner: 'rclpy_log_level' = 'loud'",
        ),
        (
            lambda it: it.inputs(location=Topic(name="/odom", msg_type="Odometry")),
            "no component was added yet",
        ),
        (lambda _: Launcher(activation_timeout=-1.0), "activation_timeout = -1.0: give seconds"),
        (lambda _: Launcher(namespace="robot 1"), "namespace = 'robot 1' is none in ROS"),
        (lambda it: setattr(it, "fallback_rate", 1.0), "no component was added yet"),
    ],
)
def test_what_cannot_be_carried_out_is_refused_and_adds_nothing(
    call: Callable[[Any], Any], message: str
) -> None:
    launcher = Launcher()
    with pytest.raises(ValueError, match=message):
        call(launcher)
    assert launcher.components == []


@pytest.mark.parametrize("when", ["added", "configured", "brought up"])
def test_a_file_that_one_component_refuses_changes_none(when: str, tmp_path: Path) -> None:
    path = tmp_path / "robot.yaml"
    path.write_text(
        "planner:\n  loop_rate: 3.0\n"
        "  inputs: {location: {name: /pose, msg_type: PoseStamped}}\n"
        "controller:\n  loop_rate: -1.0\n"
    )
    components = [planner := Planner(), Controller()]
    rate, location = planner.loop_rate, planner.in_topic_name("location")
    launcher = Launcher(config_file=str(path) if when == "added" else None)
    if when != "added":
        launcher.kompass(components)
    refused: dict[str, Callable[[], Any]] = {
        "added": lambda: launcher.kompass(components),
        "configured": lambda: launcher.configure(str(path)),
        "brought up": lambda: launcher.bringup(str(path)),
    }
    with pytest.raises(ConfigFileError, match="'loop_rate' = -1"):
        refused[when]()
    assert (planner.loop_rate, planner.in_topic_name("location")) == (rate, location)


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        (
            "twice.yaml",
            "driver: {loop_rate: 5}\ndriver: {loop_rate: 9}\n",
            r"twice\.yaml:2: 'driver' is",
        ),
        ("twice.json", '{"driver": {}, "driver": {}}', r"twice\.json: .*'driver' is given twice"),
        ("deep.yaml", "[" * 100_000, r"deep\.yaml: .*nested too deeply"),
        ("deep.json", "[" * 100_000, r"deep\.json: .*nested too deeply"),
    ],
)
def test_a_settings_file_that_says_a_thing_twice_or_never_ends_is_refused(
    tmp_path: Path, name: str, text: str, said: str
) -> None:
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ConfigFileError, match=said):
        Launcher(config_file=str(path)).add_pkg(components=[DriveManager()])


@pytest.mark.parametrize("name", ["introspect", "launch_debug"])
def test_what_another_launch_system_does_is_refused(name: str) -> None:
    launcher = Launcher()
    launcher.kompass([Planner()])
    given: Any = {name: True}
    with pytest.raises(ValueError, match=rf"bringup: {name} = True is of ROS 2 Launch"):
        launcher.bringup(**given)


def test_log_levels_are_each_their_own() -> None:
    launcher, planner = Launcher(), Planner()
    launcher.kompass([planner], ros_log_level="DEBUG", rclpy_log_level="warning")
    assert (planner.config.log_level, planner.config.rclpy_log_level) == ("debug", "warn")


def test_robot_and_frames_may_come_before_the_components() -> None:
    launcher, planner = Launcher(), Planner()
    launcher.robot = described_robot(geometry_params=[0.3, 0.5])
    launcher.frames = RobotFrames(world="world")
    launcher.kompass([planner])
    assert planner.robot == described_robot(geometry_params=[0.3, 0.5])
    assert planner.frames.world == "world"


def test_a_robot_may_come_from_the_file_and_must_be_whole(tmp_path: Path) -> None:
    path = tmp_path / "robot.json"
    path.write_text(f'{{"/**": {{"robot": {described_robot().model_dump_json()}}}}}')
    launcher, driver = Launcher(config_file=str(path)), DriveManager()
    launcher.kompass([driver])
    assert driver.robot == described_robot()
    assert not driver.lacks_robot
    path.write_text('{"/**": {"robot": {"model_type": "OMNI"}}}')
    other = Launcher(config_file=str(path))
    with pytest.raises(ConfigFileError, match=r"robot\.json: 'robot' .*geometry_params.* left out"):
        other.kompass([Planner()])
    assert other.components == []


def test_waiting_for_who_can_never_become_active_is_refused() -> None:
    launcher = Launcher(activation_timeout=5.0)
    launcher.kompass([Planner(), LocalMapper()])
    with pytest.raises(ValueError, match=r"activation_timeout = 5: planner cannot become active"):
        launcher.bringup()


def test_who_has_no_drive_manager_is_told_that_nobody_takes_the_commands(
    caplog: pytest.LogCaptureFixture,
) -> None:
    def told(*others: Any, **outputs: Any) -> bool:
        caplog.clear()
        controller = Controller()
        controller.outputs(**outputs)
        launcher = Launcher()
        launcher.kompass([controller, *others])
        stack_of(launcher)
        return "the recipe has no DriveManager" in caplog.text

    assert told()
    assert not told(DriveManager())
    assert not told(command=Topic(name="/cmd_vel", msg_type="Twist"))  # straight to the base
