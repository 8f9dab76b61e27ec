"""The service and the action by which a component is asked to do its work."""

import inspect
import threading
from typing import Any, Protocol

from rclpy.action import CancelResponse, GoalResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.task import Future

from kompass.rclpy_ext.deferred_service import create_deferred_service
from kompass.rclpy_ext.executor import MIDDLEWARE_ERRORS

SERVICE_HOOK, ACTION_HOOK = "main_service_callback", "main_action_callback"
# Fields in which services and actions tell people what went wrong; the first that there is.
_TEXTS = ("message", "error_msg", "error_message", "msg")


class Asked(Protocol):
    """What the main service and action need of their component."""

    node_name: str

    @property
    def node(self) -> Any: ...
    @property
    def is_active(self) -> bool: ...
    def main_service_callback(self, request: Any, response: Any) -> Any: ...
    def main_action_callback(self, goal_handle: Any) -> Any: ...
    def warn(self, text: str, every: float = 5.0) -> None: ...
    def on_hook_error(self, hook: str, error: Exception) -> None: ...
    def on_hook_done(self, hook: str) -> None: ...


class NotAnswered(RuntimeError):
    """There is no way to say in the response that it failed, so none is sent."""


class MainService:
    """Answers requests with ``main_service_callback``, on the thread of the component.

    While the component is inactive, and when the hook raises, ``success`` of the response is False
    and its text says why. A type without ``success`` gets no answer then: an empty one would pass
    for a result.

    Parameters
    ----------
    kind, name
        Type and name of the service.
    """

    def __init__(self, component: Asked, kind: Any, name: str) -> None:
        self._component, self._kind, self._name = component, kind, name
        create_deferred_service(component.node, kind, name, self._answer)

    async def _answer(self, request: Any, response: Any) -> Any:
        component = self._component
        if not component.is_active:
            text = f"{component.node_name} is not active; start it before /{self._name} is called"
            component.warn(text)
            return self._failed(text)
        try:
            answer = component.main_service_callback(request, response)
            if inspect.isawaitable(answer):
                answer = await answer
            if not isinstance(answer, self._kind.Response):
                raise TypeError(
                    f"it returned {answer!r}; return the response, a {self._kind.__name__}.Response"
                )
        except Exception as error:  # noqa: BLE001 - becomes the status, and the answer
            component.on_hook_error(SERVICE_HOOK, error)
            return self._failed(f"{type(error).__name__}: {error}")
        component.on_hook_done(SERVICE_HOOK)
        return answer

    def _failed(self, text: str) -> Any:
        response = self._kind.Response()
        if not isinstance(getattr(response, "success", None), bool):
            raise NotAnswered(text)
        response.success = False
        return _with_text(response, text)


class MainAction:
    """Pursues goals with ``main_action_callback``, one at a time.

    The hook runs on a thread of its own unless it is a coroutine function, so it may wait and look
    for ``goal_handle.is_cancel_requested`` meanwhile. A goal is refused while the component is not
    active, and until the goal before it has ended; every cancel request is passed on to the hook.
    When the hook raises, the goal is aborted; so it is when the component is deactivated.

    Parameters
    ----------
    kind, name
        Type and name of the action.
    """

    def __init__(self, component: Asked, kind: Any, name: str) -> None:
        self._component, self._kind, self._name = component, kind, name
        self._taken = False
        self._thread: threading.Thread | None = None
        self._handle: ServerGoalHandle | None = None
        self._server = component.node.create_action_server(
            kind,
            name,
            self._execute,
            goal_callback=self._on_goal,
            cancel_callback=lambda _handle: CancelResponse.ACCEPT,
        )

    @property
    def is_pursuing_here(self) -> bool:
        """Whether the code that asks is the hook, on its own thread."""
        return self._thread is threading.current_thread()

    def withdraw(self) -> None:
        """Abort the goal that is pursued; the hook sees that ``goal_handle.is_active`` is False."""
        handle, self._handle = self._handle, None
        if handle is not None and handle.is_active:
            handle.abort()

    def _on_goal(self, _goal: Any) -> GoalResponse:
        component = self._component
        if not component.is_active:
            text = f"{component.node_name} is not active"
            component.warn(f"a goal for /{self._name} is refused: {text}")
            return GoalResponse.REJECT
        if self._taken:
            component.warn(f"a goal for /{self._name} is refused: the last one has not ended")
            return GoalResponse.REJECT
        self._taken = True
        return GoalResponse.ACCEPT

    async def _execute(self, handle: ServerGoalHandle) -> Any:
        component = self._component
        component.node.executor.create_task(self._server.expire_goals)
        self._handle = handle
        try:
            result = await self._pursue(handle)
            if not isinstance(result, self._kind.Result):
                raise TypeError(
                    f"it returned {result!r}; return the result, a {self._kind.__name__}.Result"
                )
        except Exception as error:  # noqa: BLE001 - becomes the status, and the result
            return self._raised(handle, error)
        finally:
            self._taken = False
        if self._handle is handle:
            component.on_hook_done(ACTION_HOOK)
            self._handle = None
        return result

    async def _pursue(self, handle: ServerGoalHandle) -> Any:
        hook = self._component.main_action_callback
        if inspect.iscoroutinefunction(hook):
            return await hook(handle)
        done = Future(executor=self._component.node.executor)

        def run() -> None:
            try:
                result = hook(handle)
            except Exception as error:  # noqa: BLE001 - raised where it is awaited
                done.set_exception(error)
            else:
                done.set_result(result)

        # A daemon: a goal that does not end does not keep the process from ending.
        self._thread = threading.Thread(target=run, name=f"{self._name} goal", daemon=True)
        self._thread.start()
        return await done

    def _raised(self, handle: ServerGoalHandle, error: Exception) -> Any:
        withdrawn = self._handle is not handle
        # The hook of a goal that was withdrawn could not know, when it said how the goal ended.
        if not (withdrawn and isinstance(error, MIDDLEWARE_ERRORS)):
            self._component.on_hook_error(ACTION_HOOK, error)
        if not withdrawn:
            self._handle = None
        if handle.is_active:
            handle.abort()
        return failed_result(self._kind, error)


def failed_result(kind: Any, error: Exception) -> Any:
    """The result of a goal whose pursuit has raised: what went wrong, and never that it arrived."""
    result = kind.Result()
    if hasattr(kind.Result, "OUTCOME_ERROR"):
        result.outcome = kind.Result.OUTCOME_ERROR
    return _with_text(result, f"{type(error).__name__}: {error}")


def _with_text(message: Any, text: str) -> Any:
    """Put a text where the message has a place for one."""
    for name in _TEXTS:
        if isinstance(getattr(message, name, None), str):
            setattr(message, name, text)
            break
    return message
