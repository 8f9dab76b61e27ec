"""Log-in: role tokens in, signed session cookies out.

A session is a signed cookie, not a row in a table: the console may be killed and started again
(its supervisor does that) and nobody who was driving has to find the token first. The signing key
is derived from the role's token, so changing a token ends the sessions that were opened with it.
"""

from __future__ import annotations

import base64
import binascii
import hashlib
import hmac
import json
import secrets
import time
from collections import OrderedDict, deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from kompass_console.schema.roles import Role

SESSION_LIFETIME = 7 * 24 * 3600.0  # s

_LONGEST_USER = 40
_REVOKED_MAX = 10_000


@dataclass(frozen=True, slots=True)
class LoginSession:
    """Who is logged in: display name, role, and the id and time (epoch s) of the log-in."""

    user: str
    role: Role
    id: str
    issued: float


class Authenticator:
    """Checks tokens and cookies. Keeps no secret but the tokens it was given."""

    def __init__(
        self, access_tokens: Mapping[Role, str], *, now: Callable[[], float] = time.time
    ) -> None:
        self._tokens = dict(access_tokens)
        self._now = now
        self._revoked: OrderedDict[str, None] = OrderedDict()

    def log_in(self, token: str, user: str | None) -> LoginSession | None:
        """Session for a right token, None for a wrong one. Compares every token, always."""
        found: Role | None = None
        for role, expected in self._tokens.items():
            if secrets.compare_digest(token.encode(), expected.encode()):
                found = role
        if found is None:
            return None
        return LoginSession(
            _clean_name(user) or str(found), found, secrets.token_hex(8), self._now()
        )

    def cookie(self, session: LoginSession) -> str:
        """Signed cookie value of a session."""
        body = json.dumps([session.user, session.role, session.id, session.issued]).encode()
        return f"{_encode(body)}.{_encode(self._sign(session.role, body))}"

    def session(self, cookie: str | None) -> LoginSession | None:
        """Session of a cookie, or None when it is missing, forged, expired or logged out."""
        if not cookie:
            return None
        try:
            encoded, signature = cookie.split(".")
            body = _decode(encoded)
            user, role_name, session_id, issued = json.loads(body)
            role = Role(role_name)
            signed = _decode(signature)
        except (ValueError, TypeError, binascii.Error):
            return None
        if role not in self._tokens or not hmac.compare_digest(signed, self._sign(role, body)):
            return None
        if session_id in self._revoked or self._now() - issued > SESSION_LIFETIME:
            return None
        return LoginSession(user, role, session_id, issued)

    def log_out(self, session: LoginSession) -> None:
        """Refuse this session's cookie from now on, wherever a copy of it may be."""
        self._revoked[session.id] = None
        while len(self._revoked) > _REVOKED_MAX:
            self._revoked.popitem(last=False)

    def _sign(self, role: Role, body: bytes) -> bytes:
        key = hashlib.sha256(b"kompass-console session " + self._tokens[role].encode()).digest()
        return hmac.digest(key, body, "sha256")


class LoginLimiter:
    """Refuses addresses that fail too often.

    Parameters
    ----------
    limit
        Failed log-ins that an address may have within a period.
    period
        Seconds.
    addresses
        Number of addresses that are remembered.
    """

    def __init__(
        self,
        limit: int = 10,
        period: float = 60.0,
        *,
        now: Callable[[], float] = time.monotonic,
        addresses: int = 1000,
    ) -> None:
        self._limit = limit
        self._period = period
        self._now = now
        self._addresses = addresses
        self._failures: OrderedDict[str, deque[float]] = OrderedDict()

    def wait(self, address: str) -> float:
        """Seconds until this address may try again; 0 when it may now."""
        failures = self._failures.get(address)
        if failures is None:
            return 0.0
        while failures and self._now() - failures[0] > self._period:
            failures.popleft()
        if len(failures) < self._limit:
            return 0.0
        return self._period - (self._now() - failures[0])

    def failed(self, address: str) -> None:
        """Count one failed log-in."""
        self._failures.setdefault(address, deque(maxlen=self._limit)).append(self._now())
        self._failures.move_to_end(address)
        while len(self._failures) > self._addresses:
            self._failures.popitem(last=False)


def _clean_name(user: str | None) -> str:
    printable = "".join(c for c in user or "" if c.isprintable())
    return " ".join(printable.split())[:_LONGEST_USER]


def _encode(raw: bytes) -> str:
    return base64.urlsafe_b64encode(raw).rstrip(b"=").decode()


def _decode(text: str) -> bytes:
    return base64.urlsafe_b64decode(text + "=" * (-len(text) % 4))
