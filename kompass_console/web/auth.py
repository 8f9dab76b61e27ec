"""Log-in: tokens of roles or names and passwords in, signed session cookies out.

A session is a signed cookie, not a row in a table: the console may be killed and started again
(its supervisor does that) and nobody who was driving has to log in first. The signing key is
derived from the role's token or from the account, so changing a token, a password or a role ends
the sessions that were opened with it.
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
from dataclasses import dataclass, field, replace

from kompass_console.accounts.account import Account
from kompass_console.accounts.accounts import AccountRefused, Accounts
from kompass_console.accounts.passwords import fits
from kompass_console.schema.plain import LONGEST_NAME, plain
from kompass_console.schema.roles import Role
from kompass_console.web.addresses import one_client
from kompass_console.web.session_records import SessionRecords

SESSION_LIFETIME = 7 * 24 * 3600.0  # s
IDLE_LIMIT = 12 * 3600.0  # s

_LONGEST_COOKIE = 1000  # characters


@dataclass(frozen=True, slots=True)
class LoginSession:
    """Who is logged in: display name, role, and the id and time (epoch s) of the log-in.

    `account` is the key of the account that it belongs to; None for one by a token.
    """

    user: str
    role: Role
    id: str
    issued: float
    account: bytes | None = field(default=None, repr=False)


class Authenticator:
    """Checks tokens, passwords and cookies. Keeps no secret but the tokens it was given.

    Parameters
    ----------
    accounts
        Who may log in by name; None for nobody.
    records
        Who has logged out and who was seen; None to keep that in memory.
    lifetime, idle_limit
        Seconds that a session lasts since its log-in, and since it was last used.
    """

    def __init__(
        self,
        access_tokens: Mapping[Role, str],
        records: SessionRecords | None = None,
        accounts: Accounts | None = None,
        *,
        lifetime: float = SESSION_LIFETIME,
        idle_limit: float = IDLE_LIMIT,
        now: Callable[[], float] = time.time,
    ) -> None:
        self._tokens = dict(access_tokens)
        self._records = SessionRecords(None, now()) if records is None else records
        self._accounts = Accounts(None) if accounts is None else accounts
        self.lifetime = lifetime
        self._idle_limit = idle_limit
        self._now = now

    def log_in(
        self, token: str, user: str | None, before: LoginSession | None = None
    ) -> LoginSession | None:
        """Session for a right token, None for a wrong one. Compares every token, always.

        `before` is the session that this browser has already; the same person in the same role
        goes on with it.
        """
        found: Role | None = None
        for role, expected in self._tokens.items():
            if secrets.compare_digest(token.encode(), expected.encode()):
                found = role
        if found is None:
            return None
        name = _clean_name(user) or str(found)
        if self._accounts.find(name) is not None:
            name = f"{name} (token)"  # nobody passes for somebody else
        return self._open(name, found, None, before)

    def log_in_by_name(
        self, name: str, password: str, before: LoginSession | None = None
    ) -> LoginSession | None:
        """Session for the right password of an account, None for all else. Takes as long for a name
        that there is not; some 50 ms of a processor, so not on the web server's loop."""
        account = self._accounts.find(name)
        if not fits(None if account is None else account.password, password) or account is None:
            return None
        return self._open(account.name, account.role, account.key, before)

    @property
    def has_accounts(self) -> bool:
        """Whether anybody may log in by name."""
        return bool(self._accounts.all())

    @property
    def has_tokens(self) -> bool:
        """Whether anybody may log in by a token."""
        return bool(self._tokens)

    def end_others(self, session: LoginSession) -> LoginSession:
        """End all other sessions of an account, and give this one a new cookie.

        Raises
        ------
        AccountRefused
            When it cannot be kept, or the session is one by a token.
        """
        if session.account is None:
            raise AccountRefused("this is a log-in by a token, which many people may have")
        return replace(session, account=self._accounts.end_sessions(session.user).key)

    def cookie(self, session: LoginSession) -> str:
        """Signed cookie value of a session."""
        body = json.dumps([session.user, session.role, session.id, session.issued]).encode()
        key = self._key_of(session.role) if session.account is None else session.account
        return f"{_encode(body)}.{_encode(_sign(key, body))}"

    def session(self, cookie: str | None) -> LoginSession | None:
        """Session of a cookie, or None when it is missing, forged, expired or logged out."""
        session = self._signed(cookie)
        return session if session is not None and self.is_open(session) else None

    def is_open(self, session: LoginSession) -> bool:
        """Whether a session has not ended yet; asking counts as using it."""
        now = self._now()
        if session.account is not None and all(
            account.key != session.account for account in self._accounts.all()
        ):
            return False
        if self._records.is_revoked(session.role, session.id, session.issued):
            return False
        if now - session.issued > self.lifetime:
            return False
        seen = self._records.last_seen(session.role, session.id)
        if now - max(session.issued, seen or session.issued) > self._idle_limit:
            return False
        self._records.saw(session.role, session.id, now)
        return True

    def log_out(self, session: LoginSession) -> None:
        """Refuse this session's cookie from now on, wherever a copy of it may be."""
        self._records.revoke(session.role, session.id, session.issued)

    def save(self) -> None:
        """Write down who was seen; takes as long as the disk."""
        self._records.save()

    def _signed(self, cookie: str | None) -> LoginSession | None:
        """What a cookie says, if we said it. Nothing that is not signed is looked into."""
        if not cookie or len(cookie) > _LONGEST_COOKIE:
            return None
        try:
            encoded, signature = cookie.split(".")
            body, signed = _decode(encoded), _decode(signature)
        except (ValueError, binascii.Error):
            return None
        signer = self._signer(body, signed)
        if signer is None:
            return None
        user, role, session_id, issued = json.loads(body)
        account = signer.key if isinstance(signer, Account) else None
        return LoginSession(user, Role(role), session_id, issued, account)

    def _signer(self, body: bytes, signed: bytes) -> Role | Account | None:
        """Whose key it was signed with; who has signed told the name and the role of its own."""
        for role in self._tokens:
            if hmac.compare_digest(signed, _sign(self._key_of(role), body)):
                return role
        for account in self._accounts.all():
            if hmac.compare_digest(signed, _sign(account.key, body)):
                return account
        return None

    def _open(
        self, name: str, role: Role, account: bytes | None, before: LoginSession | None
    ) -> LoginSession:
        same = before is not None and (before.role, before.user, before.account) == (
            *(role, name, account),
        )
        session_id = before.id if same and before is not None else secrets.token_hex(8)
        return LoginSession(name, role, session_id, self._now(), account)

    def _key_of(self, role: Role) -> bytes:
        return hashlib.sha256(b"kompass-console session " + self._tokens[role].encode()).digest()


class LoginLimiter:
    """Slows down those who guess.

    An address that fails too often is refused for a while. When many addresses fail, every log-in
    waits a little before it is looked at; it is looked at in the end, so nobody who has the right
    token is kept out by what others do.

    Parameters
    ----------
    limit
        Failed log-ins that an address may have within a period.
    period
        Seconds.
    addresses
        Number of addresses that are remembered.
    limit_of_all
        Failed log-ins of all addresses within a period from which on log-ins are slowed down.
    longest_delay
        Seconds by which a log-in is slowed down at most.
    """

    def __init__(
        self,
        limit: int = 10,
        period: float = 60.0,
        *,
        now: Callable[[], float] = time.monotonic,
        addresses: int = 1000,
        limit_of_all: int = 60,
        longest_delay: float = 2.0,
    ) -> None:
        self._limit = limit
        self._period = period
        self._now = now
        self._addresses = addresses
        self._limit_of_all = limit_of_all
        self._longest_delay = longest_delay
        self._failures: OrderedDict[str, deque[float]] = OrderedDict()
        self._of_all: deque[float] = deque(maxlen=2 * limit_of_all)

    def wait(self, address: str) -> float:
        """Seconds until this address may try again; 0 when it may now."""
        failures = self._failures.get(one_client(address))
        if failures is None:
            return 0.0
        self._forget(failures)
        if len(failures) < self._limit:
            return 0.0
        return self._period - (self._now() - failures[0])

    def delay(self) -> float:
        """Seconds that any log-in has to wait before it is looked at."""
        self._forget(self._of_all)
        excess = (len(self._of_all) - self._limit_of_all) / self._limit_of_all
        return self._longest_delay * min(1.0, max(0.0, excess))

    def failed(self, address: str) -> None:
        """Count one failed log-in."""
        who = one_client(address)
        self._failures.setdefault(who, deque(maxlen=self._limit)).append(self._now())
        self._failures.move_to_end(who)
        self._of_all.append(self._now())
        while len(self._failures) > self._addresses:
            self._failures.popitem(last=False)

    def _forget(self, failures: deque[float]) -> None:
        while failures and self._now() - failures[0] > self._period:
            failures.popleft()


def _sign(key: bytes, body: bytes) -> bytes:
    return hmac.digest(key, body, "sha256")


def _clean_name(user: str | None) -> str:
    printable = "".join(c for c in (user or "") if c.isprintable())
    return plain(printable, LONGEST_NAME)


def _encode(raw: bytes) -> str:
    return base64.urlsafe_b64encode(raw).rstrip(b"=").decode()


def _decode(text: str) -> bytes:
    return base64.urlsafe_b64decode(text + "=" * (-len(text) % 4))
