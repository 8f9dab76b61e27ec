"""Components that were written for Sugarcoat, with its order of arguments, run as they did."""

import threading
from collections.abc import Callable
from typing import Any

import pytest
from kompass_interfaces.action import IntelligentRest
from nav_msgs.srv import SetMap
from ros_sugar.core import BaseComponent  # type: ignore[import-untyped]
from std_msgs.msg import Float32

from kompass.components import Component
from kompass.config import BaseComponentConfig, ComponentRunType
from kompass.ros import Topic
from tests.components.alive import Alive
from tests.components.goals import Goals
from tests.support.patience import patient
from tests.support.processes import wait_until

pytestmark = pytest.mark.ros

Run = Callable[..., Alive]
SUCCEEDED = 4


class Child(BaseComponent):  # type: ignore[misc,unused-ignore]
    """Hands everything on by position, as the tests of the original do."""

    def __init__(
        self,
        component_name: str,
        inputs: Any = None,
        outputs: Any = None,
        config: Any = None,
        config_file: Any = None,
        callback_group: Any = None,
        fallbacks: Any = None,
        main_action_type: Any = None,
        main_srv_type: Any = None,
        **kwargs: Any,
    ) -> None:
        super().__init__(
            component_name,
            inputs,
            outputs,
            config,
            config_file,
            callback_group,
            fallbacks,
            main_action_type,
            main_srv_type,
            **kwargs,
        )


def test_a_timed_one_executes_once_and_again_after_a_restart(run_on_dds: Run) -> None:
    once = threading.Event()

    class Timed(Child):
        def _execution_step(self) -> None:
            return

        def _execute_once(self) -> Any:
            once.set()
            return super()._execute_once()

    component = Timed(component_name="timed_test_component")
    component.loop_rate = 10.0
    component.run_type = "Timed"
    alive = run_on_dds(component)
    assert once.wait(patient(5))
    once.clear()
    assert alive.execute("restart").success
    assert once.wait(patient(5))


def test_a_server_whose_type_is_set_afterwards_is_called(run_on_dds: Run) -> None:
    called = threading.Event()

    class Server(Child):
        def __init__(self, component_name: str, **kwargs: Any) -> None:
            super().__init__(component_name, **kwargs)
            self.service_type = SetMap

        def main_service_callback(self, _: Any, response: Any) -> Any:
            called.set()
            return response

    component = Server(component_name="test_component")
    component.run_type = ComponentRunType.SERVER
    run_on_dds(component).call(SetMap, "set_map", SetMap.Request())
    assert called.is_set()


def test_an_action_server_that_names_its_action_offers_it_under_that_name(run_on_dds: Run) -> None:
    class Counting(Child):
        def __init__(self, component_name: str, **kwargs: Any) -> None:
            super().__init__(component_name, **kwargs)
            self.action_type = IntelligentRest
            self.main_action_name = f"{component_name}/count"
            self.run_type = ComponentRunType.ACTION_SERVER

        def _execution_step(self) -> None:
            pass

        def main_action_callback(self, goal_handle: Any) -> Any:
            goal_handle.succeed()
            return IntelligentRest.Result()

    goals = Goals(run_on_dds(Counting("counter")), IntelligentRest, "/counter/count")
    assert goals.result(goals.send()).status == SUCCEEDED


def test_topics_and_settings_may_be_given_by_position(run_on_dds: Run) -> None:
    level = Topic(name="/level", msg_type="Float32")
    component = Child("child", [level], None, BaseComponentConfig(loop_rate=20.0))
    assert component.loop_rate == 20.0
    alive = run_on_dds(component)
    alive.publisher(Float32, "/level").publish(Float32(data=1.5))
    wait_until(component.got_all_inputs, 5, "the message")
    assert component.callbacks["level"].get_output() == 1.5


def test_the_still_older_order_is_understood_and_more_than_that_is_refused() -> None:
    component = BaseComponent("x", None, None, None, None, None, True, None, IntelligentRest)
    assert component.action_type is IntelligentRest
    assert isinstance(component, Component)
    with pytest.raises(TypeError, match=r"\(5,\) is too much; after callback_group come fallba"):
        BaseComponent("x", None, None, None, None, None, None, None, None, 5)
