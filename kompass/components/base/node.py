"""The lifecycle node behind a component. It only carries transitions over to the component."""

from collections.abc import Callable

from rclpy.impl.logging_severity import LoggingSeverity
from rclpy.lifecycle import LifecycleNode, LifecycleState, TransitionCallbackReturn
from rclpy.logging import set_logger_level

from kompass.bus.node import ChangeState, Transitions
from kompass.rclpy_ext.node import (
    NodeOnDDS,
    guard_change_state,
    lifecycle_state,
    lifecycle_state_id,
)


class ComponentNode(NodeOnDDS, LifecycleNode):  # type: ignore[misc]  # rclpy has no types
    """A lifecycle node; an exception in a transition is reported and leaves the node alive."""

    def __init__(self, name: str, component: Transitions, namespace: str = "") -> None:
        super().__init__(name, namespace=namespace or None)
        self._component = component

    def set_log_levels(self, own: str, ros: str) -> None:
        """From which level on is written: its own log, and ROS' one, of the whole process."""
        for name, level in ((self.get_logger().name, own), ("rcl", ros), ("rclpy", ros)):
            set_logger_level(name, LoggingSeverity[level.upper()])

    @property
    def state(self) -> str:
        """Label of the lifecycle's state: unconfigured, inactive, active, finalized, …"""
        return lifecycle_state(self)

    @property
    def state_id(self) -> int:
        """Number of that state, as in ``lifecycle_msgs/msg/State``."""
        return lifecycle_state_id(self)

    def guard_transitions(self, guard: Callable[[ChangeState], ChangeState]) -> None:
        """Put something in front of the service for transitions.

        Parameters
        ----------
        guard
            Takes what answers the service, and returns what is to answer it.
        """
        guard_change_state(self, guard)

    def on_callback_error(self, error: Exception) -> None:
        """A callback of an action has raised: a failure of the component."""
        self._component.on_callback_error(error)

    def _carry(self, transition: str) -> TransitionCallbackReturn:
        try:
            getattr(self._component, transition)()
        except Exception as error:  # noqa: BLE001 - becomes the component's status
            self._component.on_transition_error(transition.removeprefix("on_"), error)
            return TransitionCallbackReturn.FAILURE
        return TransitionCallbackReturn.SUCCESS

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        return self._carry("on_configure")

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        super().on_activate(state)
        return self._carry("on_activate")

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        super().on_deactivate(state)
        return self._carry("on_deactivate")

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        return self._carry("on_cleanup")

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        return self._carry("on_shutdown")
