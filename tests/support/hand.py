"""A person at the wheel, as the console speaks for one, without a console."""

from __future__ import annotations

from typing import Any

from kompass_interfaces.msg import HandCommand
from kompass_interfaces.srv import TakeWheel

from kompass.rclpy_ext.topic import SENSOR
from kompass.signing.session_key import SessionKey
from kompass.store.robot_key import robot_key
from tests.support.client import Client

PERIOD = 0.1  # s between two commands; a page sends twice as many


class Hand:
    """Holds the stick at ``vx``, ``vy`` and ``omega`` while it ``sends``.

    Parameters
    ----------
    client
        At whose node it is.
    name
        Of the person.
    manager
        The drive manager.
    service
        What the client calls its service.
    """

    def __init__(
        self,
        client: Client,
        name: str,
        manager: str = "drive_manager",
        service: str = "/drive_manager/take_wheel",
    ) -> None:
        self._client, self._service = client, service
        self.name, self.session = name, f"{name}'s session"
        self.vx = self.vy = self.omega = 0.0
        self.sends = True
        self.sent: list[tuple[float, HandCommand]] = []
        self.key: SessionKey | None = None
        self._publisher = client.node.create_publisher(
            HandCommand, f"/{manager}/hand", SENSOR.to_ros()
        )
        client.wait_until(
            lambda: self._publisher.get_subscription_count() > 0, 10, "a listener to the hand"
        )
        client.node.create_timer(PERIOD, self._tick)

    def ask(self, what: int = TakeWheel.Request.TAKE) -> TakeWheel.Response:
        """Ask for the wheel, or give it up."""
        request = TakeWheel.Request(what=what, operator_name=self.name, session=self.session)
        return self._client.call(TakeWheel, self._service, request)

    def take(self, what: int = TakeWheel.Request.TAKE) -> None:
        """Get the wheel."""
        answer = self.ask(what)
        assert answer.success, answer.message
        self.key = SessionKey(robot_key(), self.session, answer.seed)

    def publish(self, command: HandCommand) -> None:
        """Send a command, whatever is in it."""
        self._publisher.publish(command)

    def command(self, **more: Any) -> HandCommand:
        """The next command; signed, if the wheel was taken."""
        now = self._client.clock.monotonic()
        fields = {"session": self.session, "sequence": len(self.sent) + 1, "sent": now}
        twist = {"vx": self.vx, "vy": self.vy, "omega": self.omega}
        command = HandCommand(**(fields | twist | more))
        return command if self.key is None else self.key.sign(command)

    def _tick(self) -> None:
        if self.sends and self.key is not None:
            command = self.command()
            self.sent.append((self._client.clock.monotonic(), command))
            self.publish(command)
