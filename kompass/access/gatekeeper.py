"""Lets requests in, or refuses them in a sentence, for the services of one node."""

from __future__ import annotations

from typing import Any

from std_msgs.msg import String

from kompass.access.ros_control import ros_control
from kompass.bus.node import Node
from kompass.printable import printable
from kompass.rclpy_ext.topic import LATCHED
from kompass.signing.proof import LIFE, Verifier
from kompass.signing.session_key import SessionKey
from kompass.store.robot_key import robot_key

CHALLENGE = "challenge"  # the topic of a node where its challenges are
LOG_PERIOD = 5.0  # s between two lines on requests that were refused

_REMEDY = (
    "use kompass-console as the user who runs the robot, or give it the robot's key with "
    "--robot-key, or start the robot with --ros-control {mode}"
)
STALE = (
    "the request is refused: its proof is too old, or from before the node was started anew; "
    "try again"
)
UNSIGNED_HAND = (
    "the request is refused: nobody drives by hand without the robot's key, whatever --ros-control "
    "says; use kompass-console as the user who runs the robot, or give it the key with --robot-key"
)
_FAULTS = {
    "stale": STALE,
    "used": "the request is refused: its proof was used before; somebody repeats what was heard",
    "wrong": "the request is refused: its proof does not fit; it was changed on the way, or made "
    "with another key",
}


def answered_challenge(message: str) -> str | None:
    """What a refusal of a proof that is too old answers it with; None of other texts."""
    text = message.removeprefix(f"{STALE} [")
    return text.removesuffix("]") if text != message else None


class NotAdmitted(Exception):
    """The request may not be; the message is a sentence for whoever asked."""


class Gatekeeper:
    """Publishes the challenges of a node, and judges who asks. Any thread may ask it.

    Parameters
    ----------
    node
        Whose services it stands before.

    Raises
    ------
    UnusableKey
        When the robot's key cannot be used.
    """

    def __init__(self, node: Node) -> None:
        self._node, self._clock = node, node.clock
        self._control = ros_control()
        self._key = robot_key()
        self._verifier = Verifier(self._key, self._clock.monotonic())
        self._publisher = node.create_publisher(
            String, f"{node.get_name()}/{CHALLENGE}", LATCHED.to_ros()
        )
        self._logged, self._refused = float("-inf"), 0
        node.create_timer(LIFE, self._renew)
        self._publish()

    def admit(self, service: str, request: Any, *, changes: bool = True, who: str = "") -> bool:
        """Let a request in that has a field for a proof.

        Parameters
        ----------
        service
            Name of the service, as the node offers it.
        changes
            Whether it may change anything.
        who
            What the request says of who asks, for the log.

        Returns
        -------
        bool
            Whether it is proved who asks: by somebody who has the robot's key.

        Raises
        ------
        NotAdmitted
            When it may not be.
        """
        if not request.proof:
            self.admit_unsigned(service, changes=changes, who=who)
            return False
        full = self._node.resolve_service_name(service)
        announced = self._verifier.announcement
        verdict = self._verifier.judge(full, request, self._clock.monotonic())
        if announced != self._verifier.announcement:
            self._publish()
        if verdict == "good":
            return True
        refusal = self._refuse(service, who, _FAULTS[verdict])
        if verdict == "stale":
            # Who has the key makes another proof with this, whatever else is on the topic.
            refusal = NotAdmitted(f"{STALE} [{self._verifier.answer(request.proof)}]")
        raise refusal

    def admit_unsigned(self, service: str, *, changes: bool = True, who: str = "") -> None:
        """Let a request in that nobody has signed.

        Raises
        ------
        NotAdmitted
            When it may not be.
        """
        if self._control == "full" or (self._control == "read" and not changes):
            return
        mode = "full" if changes else "read"
        what = "takes changes" if changes else "gives answers"
        text = (
            "the request is refused: it is not signed with the robot's key, and this robot "
            f"{what} only where it is"
        )
        raise self._refuse(service, who, f"{text}; {_REMEDY.format(mode=mode)}")

    def session_key(self, session: str, seed: str) -> SessionKey:
        """The key of a session that was agreed upon in a request that was let in."""
        return SessionKey(self._key, session, seed)

    def _refuse(self, service: str, who: str, why: str) -> NotAdmitted:
        self._refused += 1
        now = self._clock.monotonic()
        if now - self._logged >= LOG_PERIOD:
            by = f" of {printable(who, 40)!r}" if who else ""
            more = f" (and {self._refused - 1} before it)" if self._refused > 1 else ""
            self._node.get_logger().warning(f"{service}{by}: {why}{more}")
            self._logged, self._refused = now, 0
        return NotAdmitted(why)

    def _renew(self) -> None:
        self._verifier.renew(self._clock.monotonic())
        self._publish()

    def _publish(self) -> None:
        self._publisher.publish(String(data=self._verifier.announcement))
