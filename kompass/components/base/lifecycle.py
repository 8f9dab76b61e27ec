"""The life of a component: node, inputs, publishers, main loop, status."""

import time
import traceback
from collections.abc import Callable
from typing import Any

from rclpy.task import Future

from kompass.components.base.component_config import ComponentRunType
from kompass.components.base.declaration import Declaration
from kompass.components.base.health import Health
from kompass.components.base.input import Input
from kompass.components.base.node import ComponentNode
from kompass.components.base.status import StatusPublisher
from kompass.rclpy_ext.topic import QoSConfig, Topic


class Lifecycle(Declaration):
    """A declared component with a ROS node that comes and goes between its lifecycle's states.

    Node, status and services last from :meth:`create_node` to :meth:`leave`; inputs are open while
    the component is active; publishers last while it is configured.
    """

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        self.health = Health()
        self._node: ComponentNode | None = None
        self._status: StatusPublisher | None = None
        self._inputs: dict[str, list[Input]] = {}
        self._publishers: dict[str, list[Any]] = {}
        self._timers: list[Any] = []
        self._loop: Any = None
        self._active_since: float | None = None
        self._logged: dict[str, float] = {}
        self.action_problem = ""
        # Told whether the component is meant to be active, for its next life.
        self.on_intent: Callable[[bool], None] | None = None
        self._keeps_intent = False
        super().__init__(*args, **kwargs)

    @property
    def node(self) -> ComponentNode:
        """The ROS node; only in the process that runs the component."""
        if self._node is None:
            raise RuntimeError(
                f"{self.node_name} has no ROS node yet; it is made by Launcher.bringup()"
            )
        return self._node

    @property
    def is_active(self) -> bool:
        """Whether the main loop runs."""
        return self._active_since is not None

    def create_node(self, namespace: str = "") -> ComponentNode:
        """Make the ROS node; rclpy must be initialised."""
        self._node = ComponentNode(self.node_name, self, namespace)
        self._status = StatusPublisher(self._node, self.config.status_rate)
        self.init_variables()
        self.create_interfaces()
        return self._node

    def leave(self) -> None:
        """Deactivate and give the node back, before the process ends."""
        self._keeps_intent = True
        if self._node is not None:
            if self.is_active:
                self._node.trigger_deactivate()
            self._node.trigger_shutdown()
            self._node.destroy_node()
            self._node = None

    # -- transitions --------------------------------------------------------------------------

    def on_configure(self) -> None:
        try:
            for key, topics in self._topics_out.items():
                self._publishers[key] = [self._make_publisher(key, topic) for topic in topics]
            for key, topics in self._topics_in.items():
                self._inputs[key] = [Input(topic, self.qos.get(key)) for topic in topics]
            self.init_variables()
            self.custom_on_configure()
        except Exception:
            self._give_back()
            raise

    def on_activate(self) -> None:
        try:
            for key, sources in self._inputs.items():
                if self.wants_input(key):
                    for source in sources:
                        source.open(self.node)
            self.health.set_healthy()
            self._active_since = time.monotonic()
            self.custom_on_activate()
            self._start_loop()
        except Exception:
            self._active_since = None
            self._close()
            raise
        self._intend(True)
        self.publish_status()

    def on_deactivate(self) -> None:
        try:
            self.custom_on_deactivate()
        finally:
            self._active_since = None
            self._close()
            self._intend(False)

    def _intend(self, active: bool) -> None:
        if self.on_intent is not None and not self._keeps_intent:
            self.on_intent(active)

    def on_cleanup(self) -> None:
        self.custom_on_cleanup()
        self._give_back()

    def on_shutdown(self) -> None:
        self.custom_on_shutdown()

    def on_transition_error(self, transition: str, error: Exception) -> None:
        self.health.set_fail_component([self.node_name], f"{transition} failed: {error}")
        self.node.get_logger().error(f"{transition} failed: {type(error).__name__}: {error}")
        self.publish_status()

    def on_callback_error(self, error: Exception) -> None:
        """Something that ROS called here has raised: a failure that shows, and no more."""
        text = f"{type(error).__name__}: {error}"
        self.health.set_fail_component([self.node_name], text)
        where = traceback.extract_tb(error.__traceback__)[-1]
        self.warn(f"a callback failed: {text} ({where.filename}:{where.lineno})")
        self.publish_status()

    def _close(self) -> None:
        for timer in self._timers:
            self.node.destroy_timer(timer)
        self._timers, self._loop = [], None
        for sources in self._inputs.values():
            for source in sources:
                source.close(self.node)

    def _give_back(self) -> None:
        for publishers in self._publishers.values():
            for publisher in publishers:
                self.node.destroy_publisher(publisher)
        self._publishers, self._inputs = {}, {}

    def _make_publisher(self, key: str, topic: Topic) -> Any:
        qos = topic.qos_profile or self.qos.get(key) or QoSConfig()
        return self.node.create_publisher(topic.ros_msg_type, topic.name, qos.to_ros())

    def _start_loop(self) -> None:
        """Start the main loop, or start it again at another rate."""
        for timer in self._loop or ():
            self.destroy_timer(timer)
        self._loop = [self.create_timer(1.0 / self.config.loop_rate, self._tick)]
        # A slow loop must not make the component look silent.
        if self.config.loop_rate < self.config.status_rate:
            self._loop.append(self.create_timer(1.0 / self.config.status_rate, self.publish_status))

    # -- what a component overrides -----------------------------------------------------------

    def create_interfaces(self) -> None:
        """Make the services and publishers that last as long as the node, active or not."""

    def init_variables(self) -> None:
        """Make what the component needs before it runs; with the node, and at each configure."""

    def wants_input(self, key: str) -> bool:
        """Whether an input is subscribed to when the component becomes active."""
        return True

    def custom_on_configure(self) -> None:
        """After inputs and outputs are known."""

    def custom_on_activate(self) -> None:
        """Before the first step."""

    def custom_on_deactivate(self) -> None:
        """After the last step; timers and inputs are still there."""

    def custom_on_cleanup(self) -> None:
        """Give back what :meth:`custom_on_configure` took."""

    def custom_on_shutdown(self) -> None:
        """Before the process ends."""

    @property
    def longest_step(self) -> float:
        """How long a step may take by design before its process counts as stuck [s].

        What is shorter than the supervisor's own patience has no effect.
        """
        return 0.0

    def _execution_step(self) -> None:
        """One turn of the main loop. An exception becomes a component failure."""

    # -- what a component uses ----------------------------------------------------------------

    def input(self, key: str, index: int = 0) -> Input:
        """An input of the running component."""
        return self._inputs[key][index]

    def awaits(self, *sources: Input) -> list[Input]:
        """Those sources that have said nothing yet, while they still may: just after activation.

        For ``topic_subscription_timeout`` a source that has never spoken is no failure; discovery
        takes its time. One that has spoken and fell silent is.
        """
        return [source for source in sources if source.received is None and self.is_starting]

    @property
    def is_starting(self) -> bool:
        """Whether it became active less than ``topic_subscription_timeout`` ago."""
        since = self._active_since
        limit = self.config.topic_subscription_timeout
        return since is not None and time.monotonic() - since <= limit

    def publish(self, key: str, message: Any, index: int = 0) -> None:
        """Publish on an output; nothing happens when the recipe took the output away."""
        publishers = self._publishers.get(key, [])
        if index < len(publishers):
            publishers[index].publish(message)

    def publish_status(self, *, always: bool = False) -> None:
        """Publish the health when it changed or is due, or ``always``."""
        if self._status is not None:
            self._status.publish(self.health, always=always)

    def warn(self, text: str, every: float = 5.0) -> None:
        """Log a warning, the same one at most once in ``every`` seconds."""
        now = time.monotonic()
        if now - self._logged.get(text, -float("inf")) >= every:
            self._logged[text] = now
            self.node.get_logger().warning(text)

    def fails(self, problem: str) -> bool:
        """End a component action with False, and say why: ``return self.fails("…")``."""
        self.action_problem = problem
        self.warn(problem)
        return False

    def create_timer(self, period: float, callback: Callable[[], None]) -> Any:
        """A timer [s] that ends with the component's activity."""
        timer = self.node.create_timer(period, callback)
        self._timers.append(timer)
        return timer

    def destroy_timer(self, timer: Any) -> None:
        """End a timer of :meth:`create_timer` before that."""
        self._timers.remove(timer)
        self.node.destroy_timer(timer)

    async def sleep(self, seconds: float) -> None:
        """Wait in a component action; the loop and all services go on meanwhile."""
        over = Future(executor=self.node.executor)

        def ring() -> None:
            timer.cancel()
            over.set_result(None)

        timer = self.node.create_timer(seconds, ring)
        try:
            await over
        finally:
            self.node.destroy_timer(timer)

    def _tick(self) -> None:
        if self.run_type is ComponentRunType.TIMED or self.steps_in_any_run_type:
            try:
                self._execution_step()
            except Exception as error:  # noqa: BLE001 - becomes the component's status
                text = f"{type(error).__name__}: {error}"
                self.health.set_fail_component([self.node_name], text)
                self.warn(f"step failed: {text}")
        self.publish_status()
