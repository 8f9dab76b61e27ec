"""A node with the life cycle of ROS 2, on the virtual network."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

from lifecycle_msgs.msg import State, Transition, TransitionDescription, TransitionEvent
from lifecycle_msgs.srv import ChangeState, GetAvailableStates, GetAvailableTransitions, GetState
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.lifecycle import TransitionCallbackReturn

from kompass.bus.node import ChangeState as Change
from kompass.bus.node import Transitions
from kompass.virtual.node import VirtualNode
from kompass.virtual.process import VirtualProcess

# By number, in the order in which rcl has them.
STATES: dict[int, str] = {
    State.PRIMARY_STATE_UNKNOWN: "unknown",
    State.PRIMARY_STATE_UNCONFIGURED: "unconfigured",
    State.PRIMARY_STATE_INACTIVE: "inactive",
    State.PRIMARY_STATE_ACTIVE: "active",
    State.PRIMARY_STATE_FINALIZED: "finalized",
    State.TRANSITION_STATE_CONFIGURING: "configuring",
    State.TRANSITION_STATE_CLEANINGUP: "cleaningup",
    State.TRANSITION_STATE_SHUTTINGDOWN: "shuttingdown",
    State.TRANSITION_STATE_ACTIVATING: "activating",
    State.TRANSITION_STATE_DEACTIVATING: "deactivating",
    State.TRANSITION_STATE_ERRORPROCESSING: "errorprocessing",
}


class _Step(NamedTuple):
    """A transition: its number and label, and the states before and after."""

    id: int
    label: str
    start: int
    goal: int


_SUCCESS, _FAILURE, _ERROR = "transition_success", "transition_failure", "transition_error"
_UNCONFIGURED, _INACTIVE = State.PRIMARY_STATE_UNCONFIGURED, State.PRIMARY_STATE_INACTIVE
_ACTIVE, _FINALIZED = State.PRIMARY_STATE_ACTIVE, State.PRIMARY_STATE_FINALIZED
_PROCESSING = State.TRANSITION_STATE_ERRORPROCESSING


def _ends(first: int, state: int, success: int, failure: int, error: int) -> Iterable[_Step]:
    labels = (_SUCCESS, _FAILURE, _ERROR)
    for number, (label, goal) in enumerate(zip(labels, (success, failure, error), strict=True)):
        yield _Step(first + number, label, state, goal)


# As rcl_lifecycle's default state machine.
GRAPH: tuple[_Step, ...] = (
    _Step(1, "configure", _UNCONFIGURED, State.TRANSITION_STATE_CONFIGURING),
    *_ends(10, State.TRANSITION_STATE_CONFIGURING, _INACTIVE, _UNCONFIGURED, _PROCESSING),
    _Step(2, "cleanup", _INACTIVE, State.TRANSITION_STATE_CLEANINGUP),
    *_ends(20, State.TRANSITION_STATE_CLEANINGUP, _UNCONFIGURED, _INACTIVE, _PROCESSING),
    _Step(3, "activate", _INACTIVE, State.TRANSITION_STATE_ACTIVATING),
    *_ends(30, State.TRANSITION_STATE_ACTIVATING, _ACTIVE, _INACTIVE, _PROCESSING),
    _Step(4, "deactivate", _ACTIVE, State.TRANSITION_STATE_DEACTIVATING),
    *_ends(40, State.TRANSITION_STATE_DEACTIVATING, _INACTIVE, _ACTIVE, _PROCESSING),
    _Step(5, "shutdown", _UNCONFIGURED, State.TRANSITION_STATE_SHUTTINGDOWN),
    _Step(6, "shutdown", _INACTIVE, State.TRANSITION_STATE_SHUTTINGDOWN),
    _Step(7, "shutdown", _ACTIVE, State.TRANSITION_STATE_SHUTTINGDOWN),
    *_ends(50, State.TRANSITION_STATE_SHUTTINGDOWN, _FINALIZED, _FINALIZED, _PROCESSING),
    *_ends(60, _PROCESSING, _UNCONFIGURED, _FINALIZED, _FINALIZED),
)
_CALLBACKS = {
    State.TRANSITION_STATE_CONFIGURING: "on_configure",
    State.TRANSITION_STATE_CLEANINGUP: "on_cleanup",
    State.TRANSITION_STATE_SHUTTINGDOWN: "on_shutdown",
    State.TRANSITION_STATE_ACTIVATING: "on_activate",
    State.TRANSITION_STATE_DEACTIVATING: "on_deactivate",
}


class VirtualLifecycleNode(VirtualNode):
    """See :class:`kompass.bus.node.LifecycleNode`. What a transition raises makes it fail.

    Parameters
    ----------
    process
        Which it is in.
    name
        Of the node.
    component
        What the transitions are carried over to.
    namespace
        Of the node.
    """

    def __init__(
        self, process: VirtualProcess, name: str, component: Transitions, namespace: str = ""
    ) -> None:
        super().__init__(process, name, namespace)
        self._component = component
        self._state: int = _UNCONFIGURED
        self._events = self.create_publisher(TransitionEvent, "~/transition_event", 10)
        self._change_state = self.create_service(ChangeState, "~/change_state", self._on_change)
        self.create_service(GetState, "~/get_state", self._on_state)
        self.create_service(GetAvailableStates, "~/get_available_states", self._on_states)
        self.create_service(
            GetAvailableTransitions, "~/get_available_transitions", self._on_transitions
        )
        self.create_service(GetAvailableTransitions, "~/get_transition_graph", self._on_graph)

    @property
    def state(self) -> str:
        """Label of the state; that of the transition while one is under way."""
        return STATES[self._state]

    @property
    def state_id(self) -> int:
        """Its number, as in ``lifecycle_msgs/msg/State``."""
        return self._state

    def trigger_configure(self) -> TransitionCallbackReturn:
        """Become inactive.

        Raises
        ------
        rclpy._rclpy_pybind11.RCLError
            As of each transition: when it does not begin at the state as it is.
        """
        return self._trigger(Transition.TRANSITION_CONFIGURE)

    def trigger_activate(self) -> TransitionCallbackReturn:
        """Become active."""
        return self._trigger(Transition.TRANSITION_ACTIVATE)

    def trigger_deactivate(self) -> TransitionCallbackReturn:
        """Become inactive again."""
        return self._trigger(Transition.TRANSITION_DEACTIVATE)

    def trigger_cleanup(self) -> TransitionCallbackReturn:
        """Become unconfigured."""
        return self._trigger(Transition.TRANSITION_CLEANUP)

    def trigger_shutdown(self) -> TransitionCallbackReturn:
        """Become finalized, for good."""
        step = self._from_here("shutdown")
        if step is None:
            raise rclpy_implementation.RCLError("Shutdown transtion not possible")
        return self._trigger(step.id)

    def set_log_levels(self, own: str, ros: str) -> None:
        """From which level on is written; there is no log of a middleware here."""
        self.get_logger().set_level(own)

    def guard_transitions(self, guard: Callable[[Change], Change]) -> None:
        """Put something in front of the service for transitions."""
        self._change_state.callback = guard(self._change_state.callback)

    def on_callback_error(self, error: Exception) -> None:
        """A callback of an action has raised: a failure of the component."""
        self._component.on_callback_error(error)

    # -- transitions --------------------------------------------------------------------------

    def _trigger(self, number: int) -> TransitionCallbackReturn:
        self._go(number)
        outcome = self._carry(_CALLBACKS[self._state])
        self._go_by(outcome.to_label())
        if outcome == TransitionCallbackReturn.ERROR:
            self._go_by(_SUCCESS)  # nobody objects to an error: it begins anew
        return outcome

    def _carry(self, callback: str) -> TransitionCallbackReturn:
        component = self._component
        try:
            try:
                getattr(component, callback)()
            except Exception as error:  # noqa: BLE001 - becomes the component's status
                component.on_transition_error(callback.removeprefix("on_"), error)
                return TransitionCallbackReturn.FAILURE
        except Exception:  # noqa: BLE001 - rclpy makes this of what its callbacks raise
            return TransitionCallbackReturn.ERROR
        return TransitionCallbackReturn.SUCCESS

    def _from_here(self, label: str) -> _Step | None:
        return next((s for s in GRAPH if (s.start, s.label) == (self._state, label)), None)

    def _go_by(self, label: str) -> None:
        step = self._from_here(label)
        assert step is not None, "each state of a transition has all three ends"
        self._go(step.id)

    def _go(self, number: int) -> None:
        step = next((s for s in GRAPH if (s.start, s.id) == (self._state, number)), None)
        if step is None:
            raise rclpy_implementation.RCLError(
                "Failed to trigger lifecycle state machine transition: "
                f"Transition {number} is not registered for the state {self.state}."
            )
        self._state = step.goal
        start, goal = (State(id=each, label=STATES[each]) for each in (step.start, step.goal))
        # As rcl_lifecycle does, it leaves open which transition it was.
        self._events.publish(TransitionEvent(start_state=start, goal_state=goal))

    # -- services -----------------------------------------------------------------------------

    def _on_change(self, request: Any, response: Any) -> Any:
        number = request.transition.id
        if request.transition.label:
            step = self._from_here(request.transition.label)
            if step is None:
                response.success = False
                return response
            number = step.id
        response.success = self._trigger(number) == TransitionCallbackReturn.SUCCESS
        return response

    def _on_state(self, _: Any, response: Any) -> Any:
        response.current_state = State(id=self._state, label=self.state)
        return response

    def _on_states(self, _: Any, response: Any) -> Any:
        response.available_states = [State(id=n, label=label) for n, label in STATES.items()]
        return response

    def _on_transitions(self, _: Any, response: Any) -> Any:
        response.available_transitions = [
            _described(step) for step in GRAPH if step.start == self._state
        ]
        return response

    def _on_graph(self, _: Any, response: Any) -> Any:
        response.available_transitions = [_described(step) for step in GRAPH]
        return response


def _described(step: _Step) -> TransitionDescription:
    return TransitionDescription(
        transition=Transition(id=step.id, label=step.label),
        start_state=State(id=step.start, label=STATES[step.start]),
        goal_state=State(id=step.goal, label=STATES[step.goal]),
    )
