"""The key of one session: proves what is sent many times a second, without challenges."""

from typing import Any

from kompass.signing.canonical import canonical_bytes
from kompass.signing.key import RobotKey

_SESSION, _MESSAGE = b"kompass session", b"kompass message"


class SessionKey:
    """Signs and judges messages that have a field for a proof.

    Whoever has the robot's key can make it of the two random words, and nobody else. That a message
    is not used twice is for its sequence number to say.

    Parameters
    ----------
    key
        Of the robot.
    session, seed
        Random words, one of each side.
    """

    def __init__(self, key: RobotKey, session: str, seed: str) -> None:
        words = (word.encode(errors="surrogatepass") for word in (session, seed))
        self._key = RobotKey.read(key.sign(_SESSION, *words))

    def sign(self, message: Any) -> Any:
        """Give a message its proof, and return it."""
        message.proof = self._key.sign(_MESSAGE, canonical_bytes(message))
        return message

    def has_signed(self, message: Any) -> bool:
        """Whether a message carries the proof that `sign` makes."""
        return self._key.has_signed(message.proof, _MESSAGE, canonical_bytes(message))
