"""The services that every component offers, from the making of its node to its end."""

import json
from collections.abc import Awaitable
from typing import Any, Protocol

from automatika_ros_sugar.srv import (
    ChangeParameter,
    ChangeParameters,
    ConfigureFromFile,
    ExecuteMethod,
    ReplaceTopic,
)
from lifecycle_msgs.srv import ChangeState

from kompass.access.gatekeeper import Gatekeeper
from kompass.access.signed_services import SignedServices
from kompass.components.base.component_config import ComponentConfig
from kompass.components.base.health import Health
from kompass.components.base.parameter import read_values
from kompass.rclpy_ext.topic import Topic


class Served(Protocol):
    """What the services need of a component."""

    node_name: str
    config: ComponentConfig
    health: Health
    action_problem: str

    @property
    def node(self) -> Any: ...
    async def call_action(self, name: str, kwargs: Any) -> Any: ...
    def set_params(
        self, params_names: list[str], new_values: list[Any], keep_alive: bool = True
    ) -> bool: ...
    def reconfigure(self, new_config: Any, keep_alive: bool = False) -> bool: ...
    def replace_topic(self, direction: str, old_name: str, topic: Topic) -> None: ...


class ComponentServices:
    """Parameters, configuration, topics and actions of one component, over ROS.

    Every answer comes: what goes wrong is told in ``error_msg``, and nothing has changed then.
    """

    def __init__(self, component: Served, gatekeeper: Gatekeeper) -> None:
        self._component = component
        self._services = services = SignedServices(component.node, gatekeeper)
        for kind, suffix, answer in (
            (ChangeParameter, "update_config_parameter", self._on_parameter),
            (ChangeParameters, "update_config_parameters", self._on_parameters),
            (ConfigureFromFile, "configure_from_file", self._on_file),
            (ReplaceTopic, "change_topic", self._on_topic),
            (ExecuteMethod, "execute_method", self._on_execute),
        ):
            services.offer(kind, suffix, answer, _refused)
        component.node.guard_transitions(
            lambda answer: services.guard(ChangeState, "change_state", answer, _not_changed)
        )

    def answer(self, suffix: str, request: bytes) -> Awaitable[bytes]:
        """Answer a request that came past ROS; as :meth:`SignedServices.answer`."""
        return self._services.answer(suffix, request)

    def _on_parameter(
        self, request: ChangeParameter.Request, response: ChangeParameter.Response
    ) -> ChangeParameter.Response:
        errors = self._set([request.name], [request.value], request.keep_alive)
        response.success, response.error_msg = not errors[0], errors[0]
        return response

    def _on_parameters(
        self, request: ChangeParameters.Request, response: ChangeParameters.Response
    ) -> ChangeParameters.Response:
        errors = self._set(list(request.names), list(request.values), request.keep_alive)
        response.success, response.error_msg = [not error for error in errors], errors
        return response

    def _set(self, names: list[str], texts: list[str], keep_alive: bool) -> list[str]:
        """One message for each name, empty when all were set; all or none are."""
        component = self._component
        if len(names) != len(texts):
            text = f"{len(names)} names for {len(texts)} values; give one value for each name"
            return [f"{component.node_name}: {text}"] * max(len(names), 1)
        asked = dict(zip(names, texts, strict=True))
        values, refused = read_values(component.config, asked, component.node_name)
        if refused:
            others = f"not set, because {', '.join(map(repr, refused))} was refused"
            return [refused.get(name, f"{name!r}: {others}") for name in names]
        try:
            done = component.set_params(list(values), list(values.values()), keep_alive)
        except Exception as error:  # noqa: BLE001 - becomes the answer
            return [str(error) or type(error).__name__] * len(names)
        return ["" if done else self._why_not("set_params")] * len(names)

    def _on_file(
        self, request: ConfigureFromFile.Request, response: ConfigureFromFile.Response
    ) -> ConfigureFromFile.Response:
        try:
            done = self._component.reconfigure(request.path_to_file, request.keep_alive)
        except Exception as error:  # noqa: BLE001 - becomes the answer
            response.success, response.error_msg = False, str(error)
            return response
        response.success = done
        response.error_msg = "" if done else self._why_not("reconfigure")
        return response

    async def _on_execute(
        self, request: ExecuteMethod.Request, response: ExecuteMethod.Response
    ) -> ExecuteMethod.Response:
        response.success = False
        try:
            kwargs = json.loads(request.kwargs_json or "{}")
        except json.JSONDecodeError as error:
            response.error_msg = f"kwargs_json = {request.kwargs_json!r} is not JSON: {error}"
            return response
        if not isinstance(kwargs, dict):
            response.error_msg = f"kwargs_json = {request.kwargs_json!r}: give an object, {{…}}"
            return response
        try:
            result = await self._component.call_action(request.name, kwargs)
        except Exception as error:  # noqa: BLE001 - becomes the answer
            response.error_msg = f"{error}" or type(error).__name__
            return response
        response.success = result is not False
        if result is False:
            problem = self._take_problem()
            response.error_msg = self._did_not_succeed(request.name, problem)
            response.response_json = json.dumps({"problem": problem})
        elif result is not None:
            try:
                response.response_json = json.dumps(result)
            except (TypeError, ValueError) as error:
                response.error_msg = f"{request.name} was done; its result is no JSON: {error}"
        return response

    def _on_topic(
        self, request: ReplaceTopic.Request, response: ReplaceTopic.Response
    ) -> ReplaceTopic.Response:
        directions = {
            ReplaceTopic.Request.INPUT_TOPIC: "input",
            ReplaceTopic.Request.OUTPUT_TOPIC: "output",
        }
        try:
            direction = directions.get(request.direction)
            if direction is None:
                raise ValueError(f"direction = {request.direction}: give 0 (input) or 1 (output)")
            topic = Topic(name=request.new_name, msg_type=request.new_msg_type)
            self._component.replace_topic(direction, request.old_name, topic)
        except Exception as error:  # noqa: BLE001 - becomes the answer
            response.success, response.error_msg = False, str(error)
            return response
        response.success = True
        return response

    def _why_not(self, name: str) -> str:
        return self._did_not_succeed(name, self._take_problem())

    def _take_problem(self) -> str:
        component = self._component
        problem, component.action_problem = component.action_problem, ""
        return problem or ("" if component.health.is_healthy else component.health.message)

    def _did_not_succeed(self, name: str, problem: str) -> str:
        text = f"{self._component.node_name}.{name} did not succeed"
        return f"{text}: {problem}" if problem else text


def _refused(request: Any, response: Any, why: str) -> Any:
    if isinstance(response, ChangeParameters.Response):
        count = max(len(request.names), 1)
        response.success, response.error_msg = [False] * count, [why] * count
    else:
        response.success, response.error_msg = False, why
    return response


def _not_changed(
    _request: ChangeState.Request, response: ChangeState.Response, _why: str
) -> ChangeState.Response:
    response.success = False  # there is no room for words; they are in the log
    return response
