"""Who drives by hand, and what the hand asks for at this moment.

No ROS and no clock: time is an argument [s].
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Protocol

from kompass.algorithms.safety.delay import Delay
from kompass.components.drive.command_queue import STILL, Twist2D

DEAD_MAN = 0.25  # s without a command after which the robot has been told to stand
LOOK = 0.02  # s between two looks at whether that is so
WAY = 0.07  # s that a command may take from the hand, and the zero twist to the wheels
SILENT = DEAD_MAN - LOOK - WAY  # s without a command that are too many
# s of silence after which what is held must be let go first. A shorter one is a hiccup of the
# network, and the hand is known to have been there before and after it.
INTERRUPTED = 1.0
# Commands of nothing in a row that are a hand which has let go. The first may be the console's, for
# a hand that it does not hear.
RESTS = 2
LAPSE = 5.0  # s of silence after which nobody drives any more

# Why a command is not obeyed.
NOT_AT_THE_WHEEL = "it is not of who has the wheel"
NOT_SIGNED = "its proof is wrong"
REPEATED = "it is not newer than the one before"
LATE = "it was too long under way"
NO_NUMBER = "it is no finite twist"


class Command(Protocol):
    """What came: a `HandCommand` of ``kompass_interfaces``."""

    session: str
    sequence: int
    sent: float
    vx: float
    vy: float
    omega: float


Signed = Callable[[Command], bool]


@dataclass
class _Hold:
    """From one taking of the wheel to its end."""

    driver: str
    session: str
    signed: Signed
    renewed: float  # when the newest command was sent, on our clock
    sequence: int = -1
    delay: Delay = field(default_factory=Delay)
    twist: Twist2D = STILL
    asks: bool = False  # for a motion, obeyed or not
    rests: int = 0  # commands of nothing in a row
    let_go_first: bool = True  # whoever takes the wheel with the stick in the hand lets go first


class Wheel:
    """Held by one person at most, who must say again and again that the hand is still there."""

    def __init__(self) -> None:
        self._hold: _Hold | None = None

    @property
    def driver(self) -> str:
        """Who drives by hand; empty when nobody does."""
        return self._hold.driver if self._hold is not None else ""

    @property
    def session(self) -> str:
        """The word that the driver took it with; empty when nobody drives."""
        return self._hold.session if self._hold is not None else ""

    def take(self, driver: str, session: str, signed: Signed, now: float) -> None:
        """Give it to somebody, whoever had it before.

        Parameters
        ----------
        driver
            Name of the person; not empty.
        session
            A word that no other session has.
        signed
            Tells whether a command carries the proof of this session.
        """
        self._hold = _Hold(driver, session, signed, now)

    def give(self) -> None:
        """Nobody has it from now on."""
        self._hold = None

    def let_go(self) -> None:
        """What is held now must be let go before it moves the robot again."""
        if self._hold is not None:
            self._hold.twist, self._hold.let_go_first, self._hold.rests = STILL, True, 0

    def hear(self, command: Command, now: float) -> str:
        """Take a command in; why it is not obeyed, and nothing when it is."""
        hold = self._hold
        if hold is None or command.session != hold.session:
            return NOT_AT_THE_WHEEL
        if not hold.signed(command):
            return NOT_SIGNED
        if command.sequence <= hold.sequence:
            return REPEATED
        twist = (command.vx, command.vy, command.omega)
        if not all(map(math.isfinite, (*twist, command.sent))):
            return NO_NUMBER
        hold.sequence = command.sequence
        delay = hold.delay.of(command.sent, now)
        if delay >= SILENT:
            return LATE
        if now - hold.renewed >= INTERRUPTED:
            hold.let_go_first, hold.rests = True, 0
        hold.renewed = now - delay
        hold.asks = any(twist)
        hold.rests = 0 if hold.asks else hold.rests + 1
        if hold.rests >= RESTS:
            hold.let_go_first = False
        hold.twist = STILL if hold.let_go_first else twist
        return ""

    def wanted(self, now: float) -> Twist2D | None:
        """The twist (vx, vy, omega) that is asked for; None while the hand is silent."""
        hold = self._hold
        return None if hold is None or now - hold.renewed >= SILENT else hold.twist

    def is_cut(self, now: float) -> bool:
        """Whether a motion was asked for and not renewed in time; until a command comes."""
        hold = self._hold
        return hold is not None and hold.twist != STILL and now - hold.renewed >= SILENT

    def has_lapsed(self, now: float) -> bool:
        """Whether it is held by somebody of whom nothing has been heard for long."""
        return self._hold is not None and now - self._hold.renewed >= LAPSE

    def is_kept_back(self, now: float) -> bool:
        """Whether a motion is asked for that must be let go first."""
        hold = self._hold
        held = hold is not None and hold.let_go_first and hold.asks
        return held and hold is not None and now - hold.renewed < SILENT
