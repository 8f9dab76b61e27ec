"""Functions of the recipe, plain and ``async def``, are carried out: awaited, timed, cancelled."""

import asyncio
import re
import threading
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from kompass_interfaces.msg import RuleFiring
from std_msgs.msg import Float64
from std_srvs.srv import SetBool

from kompass.actions import Action, trigger_service
from kompass.components import Component, ComponentConfig, DriveManager
from kompass.components.base.actions import component_action
from kompass.monitor.execution.action_runner import ActionRunner
from kompass.monitor.execution.component_handles import NotReached, make_handles
from kompass.monitor.introspection.catalog import RecipeCatalog
from kompass.monitor.monitor import Monitor
from kompass.monitor.reporting.alarms import Alarms
from kompass.monitor.reporting.entries import ActionOutcome
from kompass.monitor.settings import MonitorSettings
from kompass.monitor.start import Start
from kompass.rclpy_ext.executor import Task
from kompass.rclpy_ext.timers import Timers
from kompass.rclpy_ext.topic import Topic
from kompass.recipe.table import recipe_rules
from kompass.ros import Event
from kompass.rulebook.permissions import Permissions
from kompass.rules.engine.firing import Firing
from kompass.rules.schema.table import Rule, Severity, Table
from tests.support.spinning import Spinning

pytestmark = pytest.mark.ros
NUMBER = Topic(name="number", msg_type="Float64")


class Carried:
    """The rule of a recipe, fired by hand; what its actions came to."""

    def __init__(
        self, spinning: Spinning, *actions: Any, components: Any = (), timeout: float | None = None
    ) -> None:
        self._spinning = spinning
        made = recipe_rules({Event(NUMBER): list(actions)}, components)
        self.rule: Rule = made.table.rules[0]
        self.told: list[ActionOutcome] = []
        self.result: tuple[bool, str] | None = None
        self.ended: list[BaseException | None] = []
        self._timeout = timeout
        self.runner = ActionRunner(
            *(spinning.node, spinning.executor, Timers(spinning.node), made.functions),
            Alarms(spinning.node, Timers(spinning.node), lambda _: None),
            permissions=Permissions({}, Table()),
            components=[one.node_name for one in components],
            restart_if_stuck=lambda component: False,
        )

    def begin(self, message: Any = None) -> Task:
        actions = self.rule.actions
        if self._timeout is not None:
            actions = tuple(a.model_copy(update={"timeout": self._timeout}) for a in actions)
        more: dict[str, Any] = {"lane": "normal", "severity": Severity.INFO, "actions": actions}
        messages = {"number": message} if message is not None else {}
        firing = Firing(
            "r", 1, 0.0, 0.0, "hash", None, message, messages, (), rule=self.rule, **more
        )

        async def run() -> None:
            self.result = await self.runner.run(firing, self.told.append)

        return Task(run(), self.ended.append)

    def run(self, message: Any = None) -> tuple[bool, str]:
        """Whether all went well, and the first error."""
        self.begin(message)
        self._spinning.until(lambda: self.ended, 20.0)
        assert self.ended == [None]
        assert self.result is not None
        return self.result


@pytest.fixture
def carried(spinning: Spinning) -> Iterator[Callable[..., Carried]]:
    made: list[Carried] = []

    def make(*actions: Any, **more: Any) -> Carried:
        made.append(Carried(spinning, *actions, **more))
        return made[-1]

    yield make
    for each in made:
        each.runner.close()


Make = Callable[..., Carried]


def test_an_async_function_is_awaited_and_its_result_told(carried: Make) -> None:
    seen: list[str] = []

    async def dock(where: str) -> str:
        await asyncio.sleep(0.05)
        seen.append(where)
        return f"docked at {where}"

    run = carried(Action(dock, args=("home",)), Action(lambda: seen.append("after")))
    assert run.run() == (True, "")
    assert [each.text for each in run.told] == ["docked at home", ""]
    assert seen == ["home", "after"]


def test_what_an_async_function_raises_is_told_and_ends_the_list(carried: Make) -> None:
    async def dock() -> None:
        await asyncio.sleep(0)
        raise RuntimeError("no dock in sight")

    run = carried(Action(dock), Action(lambda: None))
    assert run.run() == (False, "python dock: no dock in sight")
    assert len(run.told) == 1


def test_an_async_function_that_returns_false_has_failed(carried: Make) -> None:
    async def dock() -> bool:
        return False

    assert carried(Action(dock)).run() == (False, "python dock: dock returned False")


def test_a_function_that_returns_what_is_to_be_awaited_is_awaited(carried: Make) -> None:
    async def dock() -> str:
        return "docked"

    run = carried(Action(lambda: dock()))
    run.run()
    assert run.told[0].text == "docked"


def test_an_async_function_is_cancelled_when_its_time_is_over(carried: Make) -> None:
    cancelled = threading.Event()

    async def dock() -> None:
        try:
            await asyncio.sleep(60)
        except asyncio.CancelledError:
            cancelled.set()
            raise

    run = carried(Action(dock), timeout=0.3)
    assert run.run() == (False, "python dock: dock did not return within 0.3 s")
    assert cancelled.wait(5.0)


def test_an_async_function_is_cancelled_with_its_run(carried: Make, spinning: Spinning) -> None:
    begun, cancelled = threading.Event(), threading.Event()

    async def dock() -> None:
        begun.set()
        try:
            await asyncio.sleep(60)
        except asyncio.CancelledError:
            cancelled.set()
            raise

    run = carried(Action(dock))
    task = run.begin()
    spinning.until(begun.is_set)
    task.cancel()
    assert cancelled.wait(5.0)
    assert len(run.ended) == 1


def test_exit_in_a_function_ends_the_action_and_nothing_else(carried: Make) -> None:
    def leave() -> None:
        raise SystemExit(3)

    ok, error = carried(Action(leave)).run()
    assert not ok
    assert "leave" in error
    assert "SystemExit" in error


def test_a_parser_may_be_async(carried: Make) -> None:
    said: list[str] = []

    async def words(*, msg: Float64, **_: object) -> str:
        await asyncio.sleep(0)
        return f"it is {msg.data}"

    def say(text: str) -> None:
        said.append(text)

    action = Action(say)
    action.event_parser(words, output_mapping="text")
    assert carried(action).run(Float64(data=2.0)) == (True, "")
    assert said == ["it is 2.0"]


def test_a_parser_of_a_request_may_be_async_and_holds_up_nobody(
    carried: Make, spinning: Spinning
) -> None:
    asked: list[bool] = []

    def switch(request: Any, response: Any) -> Any:
        asked.append(request.data)
        response.success = True
        return response

    spinning.node.create_service(SetBool, "lamp_of_a_parser", switch)
    began: list[str] = []

    async def request(*, msg: Float64, **_: object) -> SetBool.Request:
        began.append(threading.current_thread().name)
        return SetBool.Request(data=msg.data > 1)

    action = trigger_service(srv_name="lamp_of_a_parser", srv_type=SetBool)
    action.event_parser(request, output_mapping="srv_request_msg")
    assert carried(action, timeout=15.0).run(Float64(data=2.0)) == (True, "")
    assert asked == [True]
    assert began[0] != threading.main_thread().name


# -- fallbacks ------------------------------------------------------------------------------------


def test_plain_and_parsed_functions_are_carried_out_as_fallbacks(spinning: Spinning) -> None:
    done: list[str] = []

    def honk() -> None:
        done.append("honk")

    async def wave() -> None:
        done.append("wave")

    def say(text: str) -> None:
        done.append(text)

    parsed = Action(say)
    parsed.event_parser(lambda *, msg, **_: f"status {msg.data}", output_mapping="text")
    driver = DriveManager()
    driver.on_fail([honk, Action(wave), parsed])
    made = recipe_rules({}, [driver])
    (rule,) = (each for each in made.table.rules if each.id == "drive-manager-on-fail")
    run = Carried(spinning, Action(honk))
    run.rule = rule
    run.runner.close()
    run.runner = ActionRunner(
        *(spinning.node, spinning.executor, Timers(spinning.node), made.functions),
        Alarms(spinning.node, Timers(spinning.node), lambda _: None),
        permissions=Permissions({}, Table()),
        components=(),
        restart_if_stuck=lambda component: False,
    )
    for _ in range(3):
        run.ended.clear()
        assert run.run(Float64(data=3.0)) == (True, "")
    assert done == ["honk", "wave", "status 3.0"]
    run.runner.close()


# -- conditions -----------------------------------------------------------------------------------


class Asked:
    """A monitor with the rules of a recipe, and what it tells of them."""

    def __init__(self, spinning: Spinning, events_actions: Any) -> None:
        node = spinning.node
        self.steps: list[Any] = []
        node.create_subscription(RuleFiring, f"{node.get_name()}/firings", self.steps.append, 100)
        recipe = recipe_rules(events_actions, [])
        self.monitor = Monitor(
            *(node, spinning.executor, recipe, RecipeCatalog([], recipe)),
            start=Start(recipe.table, 1, "epoch"),
            store=None,
            settings=MonitorSettings(robot="test"),
            ask=lambda _: None,
        )

    def phases(self, phase: str) -> list[Any]:
        return [step for step in self.steps if step.phase == phase]


@pytest.fixture
def asked(spinning: Spinning) -> Iterator[Callable[[Any], Asked]]:
    made: list[Asked] = []

    def make(events_actions: Any) -> Asked:
        made.append(Asked(spinning, events_actions))
        return made[-1]

    yield make
    for each in made:
        each.monitor.close()


Ask = Callable[[Any], Asked]


def test_an_async_condition_is_awaited(asked: Ask, spinning: Spinning) -> None:
    answers = {"far": False, "near": True}

    def at(where: str) -> Callable[[], Any]:
        async def is_there() -> bool:
            await asyncio.sleep(0)
            return answers[where]

        return is_there

    done: list[str] = []
    asked(
        {
            Event(at("far"), on_change=True, check_rate=50): Action(lambda: done.append("far")),
            Event(at("near"), on_change=True, check_rate=50): Action(lambda: done.append("near")),
        }
    )
    spinning.until(lambda: done)
    assert done == ["near"]
    answers["far"] = True
    spinning.until(lambda: len(done) > 1)
    assert done == ["near", "far"]


def test_a_condition_that_raises_is_unknown_and_the_journal_tells_it_once(
    asked: Ask, spinning: Spinning
) -> None:
    state = {"broken": False, "asked": 0}

    async def ready() -> bool:
        state["asked"] += 1
        if state["broken"]:
            raise OSError("no such sensor")
        return True

    watching = asked(
        {Event(ready, check_rate=50).as_rule("steady", hold=0.8): Action(lambda: None)}
    )
    spinning.until(lambda: state["asked"] > 2)
    # What it said last does not count any more: it never holds for long enough.
    state["broken"] = True
    spinning.until(lambda: watching.phases("note"))
    before = state["asked"]
    spinning.until(lambda: state["asked"] > before + 60)
    notes = [step.text for step in watching.phases("note")]
    assert notes == ["the condition 'ready' raised OSError: no such sensor"]
    assert watching.phases("fired") == []
    state["broken"] = False
    spinning.until(lambda: watching.phases("fired"))


def test_a_condition_that_does_not_answer_is_told_and_cancelled(
    asked: Ask, spinning: Spinning, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("kompass.monitor.inputs.polled_functions.LONGEST", 0.3)
    cancelled = threading.Event()

    async def ready() -> bool:
        try:
            await asyncio.sleep(60)
        except asyncio.CancelledError:
            cancelled.set()
            raise
        return True

    watching = asked({Event(ready, check_rate=50): Action(lambda: None)})
    spinning.until(lambda: watching.phases("note"))
    assert watching.phases("note")[0].text == "the condition 'ready' has not answered for 0.3 s"
    assert cancelled.wait(5.0)


# -- components -----------------------------------------------------------------------------------


class LampConfig(ComponentConfig):
    brightness: float = 1.0


class Lamp(Component):
    config_class = LampConfig
    config: LampConfig
    VOLTS = 12

    @component_action
    def switch(self, on: bool) -> bool:
        """Switch it."""
        self.config.brightness = 1.0 if on else 0.0
        return on

    @component_action
    async def fade(self, to: float) -> str:
        """Fade."""
        await self.sleep(0.01)
        self.config.brightness = to
        return f"faded to {to}"

    def colour(self) -> str:
        return "white"


def switched_in_its_process(lamp: Lamp) -> float:
    return lamp.config.brightness


@pytest.fixture
def lamps(spinning: Spinning) -> Iterator[tuple[Lamp, Lamp]]:
    """A component that runs, and the copy that the monitor's process has of it."""
    real, copy = Lamp("lamp"), Lamp("lamp")
    node = real.create_node()
    spinning.executor.add_node(node)
    node.trigger_configure()
    node.trigger_activate()
    yield real, copy
    node.trigger_deactivate()
    # A timer may have come due before that: it is served while the component is still there.
    served = spinning.executor.create_task(lambda: None)
    spinning.until(served.done)
    spinning.executor.remove_node(node)
    real.leave()


def carried_with(carried: Make, lamp: Lamp, *functions: Any) -> Carried:
    run = carried(*(Action(one) for one in functions), components=[lamp])
    make_handles([lamp], run.runner.reach)
    return run


def test_a_function_reaches_the_actions_of_the_component_itself(
    carried: Make, lamps: tuple[Lamp, Lamp]
) -> None:
    real, lamp = lamps
    got: list[Any] = []

    def off() -> None:
        got.append(lamp.switch(False))

    def on() -> None:
        got.append(lamp.switch(on=True))

    def fade() -> None:
        got.append(lamp.fade(0.5))

    async def fade_more() -> None:
        got.append(await lamp.fade(to=0.25))

    for function, brightness in ((off, 0.0), (on, 1.0), (fade, 0.5), (fade_more, 0.25)):
        lamp = Lamp("lamp")
        assert carried_with(carried, lamp, function).run() == (True, "")
        assert switched_in_its_process(real) == brightness
    assert got == [False, True, "faded to 0.5", "faded to 0.25"]


def test_a_function_changes_settings_of_the_component_itself(
    carried: Make, lamps: tuple[Lamp, Lamp]
) -> None:
    real, lamp = lamps

    def dim() -> bool:
        return lamp.set_param("brightness", 0.125)

    assert carried_with(carried, lamp, dim).run() == (True, "")
    assert switched_in_its_process(real) == 0.125


@pytest.mark.parametrize(
    ("use", "sentence"),
    [
        (lambda lamp: lamp.config.brightness, r"lamp\.config is not reached from here: .*switch"),
        (lambda lamp: lamp.health.is_healthy, r"lamp\.health is not reached from here"),
        (lambda lamp: lamp.is_active, r"lamp\.is_active is not reached from here"),
        (lambda lamp: lamp.colour(), r"lamp\.colour is not reached from here"),
        (lambda lamp: setattr(lamp, "loop_rate", 5.0), r"set_param\('loop_rate', 5\.0\)"),
        (lambda lamp: lamp.switch(), r"lamp\.switch: .*'on'; it takes \(on"),
        (lambda lamp: lamp.fade("far away"), r"could not|float|number|str"),
    ],
)
def test_what_a_function_does_not_reach_is_told_in_the_journal(
    carried: Make, lamps: tuple[Lamp, Lamp], use: Callable[[Any], Any], sentence: str
) -> None:
    _, lamp = lamps
    run = carried_with(carried, lamp, lambda: use(lamp))
    ok, error = run.run()
    assert not ok
    assert re.search(sentence, error), error


def test_where_no_action_can_be_called_that_is_refused_too() -> None:
    lamp = Lamp("lamp")
    make_handles([lamp], None)
    with pytest.raises(
        NotReached, match=r"lamp\.switch is not reached from here.*let a rule do it"
    ):
        lamp.switch(True)
    with pytest.raises(AttributeError, match="dim"):
        lamp.dim()  # type: ignore[attr-defined]


def test_what_never_changes_is_as_it_was(carried: Make, lamps: tuple[Lamp, Lamp]) -> None:
    _, lamp = lamps
    seen: list[Any] = []

    def look() -> None:
        seen.extend([lamp.node_name, lamp.status_topic.name, lamp.VOLTS, isinstance(lamp, Lamp)])
        seen.append(repr(lamp))

    assert carried_with(carried, lamp, look).run() == (True, "")
    assert seen == ["lamp", "lamp/status", 12, True, "Lamp('lamp')"]
