"""Health of a component, and how it is published: a level, a sentence, and who caused it."""

from dataclasses import dataclass, field

from automatika_ros_sugar.msg import ComponentStatus

from kompass.bus.node import LifecycleNode
from kompass.rclpy_ext.topic import LATCHED

TEXTS = {
    ComponentStatus.STATUS_HEALTHY: "Running - Healthy",
    ComponentStatus.STATUS_FAILURE_ALGORITHM_LEVEL: "Failure: Algorithm Level",
    ComponentStatus.STATUS_FAILURE_COMPONENT_LEVEL: "Failure: Component Level",
    ComponentStatus.STATUS_FAILURE_SYSTEM_LEVEL: "Failure: System Level",
    ComponentStatus.STATUS_GENERAL_FAILURE: "Failure: General",
}

HEALTHY_TEXT = TEXTS[ComponentStatus.STATUS_HEALTHY]
# Nothing has failed in one that is not active: a rule that answers failures must not start it.
INACTIVE_TEXT = "Inactive - it does nothing until it is started"


@dataclass
class Health:
    """What a component says of itself. Setting a level replaces the sources of the last one."""

    level: int = ComponentStatus.STATUS_HEALTHY
    message: str = HEALTHY_TEXT
    topics: list[str] = field(default_factory=list)
    components: list[str] = field(default_factory=list)
    algorithms: list[str] = field(default_factory=list)

    @property
    def is_healthy(self) -> bool:
        """True unless a failure is set."""
        return bool(self.level == ComponentStatus.STATUS_HEALTHY)

    def set_healthy(self, message: str = "") -> None:
        """Clear the failure and its sources; ``message`` tells e.g. what is waited for."""
        self._set(ComponentStatus.STATUS_HEALTHY, message)

    def set_inactive(self) -> None:
        """It was stopped, or has not been started."""
        self._set(ComponentStatus.STATUS_HEALTHY, "")
        self.message = INACTIVE_TEXT

    def set_fail_algorithm(
        self,
        algorithms: list[str] | None = None,
        message: str = "",
        *,
        algorithm_names: list[str] | None = None,
    ) -> None:
        """The data is there, and no answer was found; both keywords name the algorithms."""
        self._set(
            ComponentStatus.STATUS_FAILURE_ALGORITHM_LEVEL,
            message,
            algorithms=algorithms or algorithm_names,
        )

    def set_fail_component(
        self,
        components: list[str] | None = None,
        message: str = "",
        *,
        component_names: list[str] | None = None,
    ) -> None:
        """A defect of the component itself; both keywords name the components."""
        self._set(
            ComponentStatus.STATUS_FAILURE_COMPONENT_LEVEL,
            message,
            components=components or component_names,
        )

    def set_fail_system(
        self,
        *,
        topics: list[str] | None = None,
        components: list[str] | None = None,
        message: str = "",
        topic_names: list[str] | None = None,
        component_names: list[str] | None = None,
    ) -> None:
        """Something outside is missing: an input, a peer, a device.

        By keyword only, because stacks differ in which comes first; ``topic_names`` and
        ``component_names`` are other names of ``topics`` and ``components``.
        """
        self._set(
            ComponentStatus.STATUS_FAILURE_SYSTEM_LEVEL,
            message,
            topics=topics or topic_names,
            components=components or component_names,
        )

    def set_failure(self, message: str = "") -> None:
        """A failure of no certain kind."""
        self._set(ComponentStatus.STATUS_GENERAL_FAILURE, message)

    @property
    def value(self) -> int:
        """The level, as in ``ComponentStatus.status``; to be set to one of 0 to 4."""
        return self.level

    @value.setter
    def value(self, level: int) -> None:
        if isinstance(level, bool) or not isinstance(level, int):
            raise TypeError(f"health_status.value = {level!r} is not a whole number")
        if level not in TEXTS:
            known = ", ".join(f"{number} ({text})" for number, text in TEXTS.items())
            raise ValueError(f"health_status.value = {level} is no level; known are {known}")
        self._set(level, "")

    @property
    def is_algorithm_fail(self) -> bool:
        """Whether an algorithm finds no answer."""
        return bool(self.level == ComponentStatus.STATUS_FAILURE_ALGORITHM_LEVEL)

    @property
    def is_component_fail(self) -> bool:
        """Whether the component itself has a defect."""
        return bool(self.level == ComponentStatus.STATUS_FAILURE_COMPONENT_LEVEL)

    @property
    def is_system_fail(self) -> bool:
        """Whether something outside is missing."""
        return bool(self.level == ComponentStatus.STATUS_FAILURE_SYSTEM_LEVEL)

    @property
    def is_general_fail(self) -> bool:
        """Whether it is a failure of no certain kind."""
        return bool(self.level == ComponentStatus.STATUS_GENERAL_FAILURE)

    def _set(
        self,
        level: int,
        message: str,
        *,
        topics: list[str] | None = None,
        components: list[str] | None = None,
        algorithms: list[str] | None = None,
    ) -> None:
        self.level = level
        self.message = f"{TEXTS[level]} - {message}" if message else TEXTS[level]
        self.topics = topics or []
        self.components = components or []
        self.algorithms = algorithms or []

    def to_msg(self) -> ComponentStatus:
        """As it is published."""
        return ComponentStatus(
            status=self.level,
            msg=self.message,
            src_topics=list(self.topics),
            src_components=list(self.components),
            src_algorithms=list(self.algorithms),
        )


class StatusPublisher:
    """A change goes out at once, and the same again at ``rate`` Hz, so silence means something.

    Published on ``<node>/status`` and ``<node>_status``; latched, so a late listener knows.
    """

    def __init__(self, node: LifecycleNode, rate: float) -> None:
        names = (f"{node.get_name()}/status", f"{node.get_name()}_status")
        qos = LATCHED.to_ros()
        self._publishers = [node.create_publisher(ComponentStatus, name, qos) for name in names]
        self._clock = node.clock
        self._period = 1.0 / rate
        self._last: ComponentStatus | None = None
        self._sent = 0.0

    def set_rate(self, rate: float) -> None:
        """Repeat at another rate [Hz] from now on."""
        self._period = 1.0 / rate

    def publish(self, health: Health, *, always: bool = False) -> None:
        """Send when something changed or the period has passed, or ``always``."""
        message = health.to_msg()
        now = self._clock.monotonic()
        due = always or now - self._sent >= 0.95 * self._period
        if message == self._last and not due:
            return
        self._last, self._sent = message, now
        for publisher in self._publishers:
            publisher.publish(message)
