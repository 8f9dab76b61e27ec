"""The wheel of the drive manager: taken, turned and given up by a person at a page."""

from __future__ import annotations

import secrets
import time
from typing import Any

from kompass_interfaces.msg import HandCommand
from kompass_interfaces.srv import TakeWheel
from rclpy.exceptions import InvalidHandle
from rclpy.node import Node

from kompass.rclpy_ext.reply import NoAnswer
from kompass.rclpy_ext.topic import SENSOR
from kompass.signing.session_key import SessionKey
from kompass_console.link.graph.discovery import Graph
from kompass_console.link.graph.services import ServicePool, found
from kompass_console.schema.plain import plain

TIMEOUT = 1.5  # s in which the drive manager answers, a second proof included
FOUND_WITHIN = 1.5  # s in which one shows up of a stack that has just come

_HAND = "hand"  # topic beside the service


class WheelRefused(Exception):
    """The drive manager does not give the wheel; the message is its sentence."""


class Hold:
    """The wheel in somebody's hand, from its taking to its end.

    Attributes
    ----------
    service
        Of the drive manager.
    session
        The word that it was taken with.
    limits
        Of the robot (vx, vy, omega) [m/s, m/s, rad/s].
    """

    def __init__(
        self, service: str, session: str, key: SessionKey, answer: Any, publisher: Any
    ) -> None:
        self.service, self.session = service, session
        self.limits = (float(answer.max_vx), float(answer.max_vy), float(answer.max_omega))
        self._key, self._publisher = key, publisher
        self._sequence = 0

    def drive(self, vx: float, vy: float, omega: float, age: float = 0.0) -> bool:
        """Ask for a twist from now on, for as long as it is renewed [m/s, m/s, rad/s].

        Parameters
        ----------
        age
            How old the word of the hand is [s]: the drive manager counts from when it was said.

        Returns
        -------
        bool
            Whether it was sent; not when the drive manager has gone, which is for good.
        """
        self._sequence += 1
        command = HandCommand(
            session=self.session,
            sequence=self._sequence,
            sent=time.monotonic() - age,
            vx=vx,
            vy=vy,
            omega=omega,
        )
        try:
            self._publisher.publish(self._key.sign(command))
        except InvalidHandle:  # `WheelLink.refresh` destroyed it
            return False
        return True


class WheelLink:
    """The wheel of the first drive manager on the graph (there should be one)."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._pool = ServicePool(node, TakeWheel, "kompass_interfaces/srv/TakeWheel")
        # Made before they are needed: what is published before they are found is lost.
        self._publishers: dict[str, Any] = {}

    def refresh(self, services: Graph) -> None:
        """Keep the drive managers connected that are there now; on the link's thread."""
        self._pool.refresh(services)
        names = self._pool.names
        publishers = dict(self._publishers)
        gone = [publishers.pop(name) for name in list(publishers) if name not in names]
        for name in names:
            if name not in publishers:
                topic = f"{name.rpartition('/')[0]}/{_HAND}"
                publishers[name] = self._node.create_publisher(HandCommand, topic, SENSOR.to_ros())
        self._publishers = publishers
        for publisher in gone:
            self._node.destroy_publisher(publisher)

    async def take(self, operator: str, *, over: bool = False) -> Hold:
        """Take the wheel for somebody.

        Parameters
        ----------
        operator
            Name of the person.
        over
            From whoever has it.

        Raises
        ------
        NoAnswer
            When there is no drive manager, or it does not answer within `TIMEOUT`.
        WheelRefused
            When it does not give the wheel.
        """
        await found(lambda: self._publishers, FOUND_WITHIN)
        # Anybody on the robot's network can offer such a service; the robot's has a key of ours.
        strange = lambda name: (self._pool.key_of(name) is None, name)  # noqa: E731
        service = min(self._publishers, key=strange, default=None)
        if service is None:
            raise NoAnswer("no drive manager that can be driven by hand is there")
        session = secrets.token_hex(16)
        what = TakeWheel.Request.TAKE_OVER if over else TakeWheel.Request.TAKE
        request = TakeWheel.Request(what=what, operator_name=operator, session=session)
        answer = await self._pool.call(request, TIMEOUT, service)
        if not answer.success:
            raise WheelRefused(plain(answer.message))
        key, publisher = self._pool.key_of(service), self._publishers.get(service)
        if key is None or publisher is None:
            raise NoAnswer("the drive manager has just been started anew")
        return Hold(service, session, SessionKey(key, session, answer.seed), answer, publisher)

    async def give(self, hold: Hold, operator: str) -> None:
        """Give the wheel up; nothing happens when somebody else has it by now.

        Raises
        ------
        NoAnswer
            When the drive manager does not answer; it frees the wheel by itself after 5 s.
        """
        request = TakeWheel.Request(
            what=TakeWheel.Request.GIVE, operator_name=operator, session=hold.session
        )
        await self._pool.call(request, TIMEOUT, hold.service)
