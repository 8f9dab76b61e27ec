"""The key of a robot: who has it is believed."""

import hmac
import secrets
from typing import Self

SIZE = 32  # bytes


class NoKey(ValueError):
    """A text that is no key."""


class RobotKey:
    """A secret that a robot shares with those who may change it.

    Parameters
    ----------
    secret
        32 bytes.
    """

    __slots__ = ("_secret",)

    def __init__(self, secret: bytes) -> None:
        if len(secret) != SIZE:
            raise NoKey(f"a key has {SIZE} bytes, this has {len(secret)}")
        self._secret = secret

    @classmethod
    def new(cls) -> Self:
        """Make one that nobody can guess."""
        return cls(secrets.token_bytes(SIZE))

    @classmethod
    def read(cls, text: str) -> Self:
        """Read what `text` wrote.

        Raises
        ------
        NoKey
            When it is something else.
        """
        try:
            secret = bytes.fromhex(text.strip())
        except ValueError:
            raise NoKey(f"a key is {2 * SIZE} hexadecimal digits, and this is not") from None
        return cls(secret)

    @property
    def text(self) -> str:
        """The secret in hexadecimal digits, for its file."""
        return self._secret.hex()

    def sign(self, *parts: bytes) -> str:
        """HMAC-SHA256 over parts, in hexadecimal; where one part ends counts too."""
        joined = b"".join(len(part).to_bytes(8, "big") + part for part in parts)
        return hmac.digest(self._secret, joined, "sha256").hex()

    def has_signed(self, mark: str, *parts: bytes) -> bool:
        """Whether `sign` makes this of the parts; takes as long when it does not."""
        return hmac.compare_digest(self.sign(*parts).encode(), mark.encode(errors="surrogatepass"))

    def __repr__(self) -> str:
        return "RobotKey(…)"  # never in a log
