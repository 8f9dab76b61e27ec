"""What the console is told by whoever starts it."""

from __future__ import annotations

import ipaddress
from pathlib import Path
from typing import Annotated, Self

from pydantic import BaseModel, ConfigDict, Field, field_validator, model_validator

from kompass_console.drills.subject import DrillSubject
from kompass_console.schema.models import Theme
from kompass_console.schema.roles import Role
from kompass_console.webhooks.settings import Webhook

_SHORTEST_TOKEN = 16
_DAY = 24 * 3600.0  # s

Seconds = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
Count = Annotated[int, Field(ge=1)]


class TopicOverrides(BaseModel):
    """Topic names to read instead of those found on the ROS graph (None: look for one)."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    odometry: str | None = None
    scan: str | None = None
    map: str | None = None
    local_map: str | None = None
    plan: str | None = None


class ConnectionLimits(BaseModel):
    """How many connections there may be, and how long (s) one may keep the console waiting.

    Attributes
    ----------
    total, of_one_address
        Connections of any kind. Those of a trusted proxy count in the total only.
    header_time, body_time
        For the head and the body of one request to arrive.
    keep_alive
        Until a connection without a request is closed.
    unread_time
        Until a connection is dropped that takes nothing of what was sent.
    sockets_of_session
        Websockets of one log-in; a page has up to six.
    sockets_of_viewers
        Websockets of all viewers together, so that they leave room for those who drive.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    total: Count = 400
    of_one_address: Count = 200
    header_time: Seconds = 10.0
    body_time: Seconds = 30.0
    keep_alive: Seconds = 15.0
    unread_time: Seconds = 10.0
    sockets_of_session: Count = 32
    sockets_of_viewers: Count = 160


class ConsoleSettings(BaseModel):
    """Settings of one console; unknown names are errors.

    Attributes
    ----------
    access_tokens
        The secret of each role that may log in by it.
    accounts_file
        Who may log in by name; None for nobody.
    allow_hosts
        Names that a browser may use in the address bar besides loopback names and literal
        addresses.
    audit_folder
        Where the audit log is kept; None where it cannot be, which people are told.
    recordings
        Folder of the robot's recordings; None where it is not on this machine.
    drill
        The recipe of the robot at hand; None where the console does not have it.
    domain_id
        None for the environment's ROS_DOMAIN_ID.
    sessions_file
        Remembers over a restart who has logged out; None to forget.
    session_lifetime, idle_limit
        Seconds after which somebody has to log in again: since the log-in, and since a page of
        theirs was last open.
    trusted_proxies
        Addresses whose word on the client's own (X-Forwarded-For, -Proto) is believed.
    stop_without_login
        Whether whoever reaches the console may press STOP without a log-in.
    webhooks
        Who is told of what happens to the robot; nobody, if there are none.
    tls_cert, tls_key
        Files (PEM) to serve https with; both or none.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    robot_name: str = "robot"
    access_tokens: dict[Role, str]
    accounts_file: Path | None = None
    theme: Theme = "light"
    topics: TopicOverrides = TopicOverrides()
    allow_hosts: tuple[str, ...] = ()
    audit_folder: Path | None = None
    recordings: Path | None = None
    drill: DrillSubject | None = None
    domain_id: int | None = Field(default=None, ge=0, le=232)
    sessions_file: Path | None = None
    session_lifetime: Seconds = 7 * _DAY
    idle_limit: Seconds = _DAY / 2
    trusted_proxies: tuple[str, ...] = ()
    stop_without_login: bool = True
    webhooks: tuple[Webhook, ...] = ()
    tls_cert: Path | None = None
    tls_key: Path | None = None
    limits: ConnectionLimits = ConnectionLimits()
    static_dir: Path = Path(__file__).parent / "static"

    @field_validator("access_tokens")
    @classmethod
    def _tokens_are_secrets(cls, tokens: dict[Role, str]) -> dict[Role, str]:
        for role, token in tokens.items():
            if len(token) < _SHORTEST_TOKEN:
                raise ValueError(
                    f"access_tokens[{role}] has {len(token)} characters; "
                    f"use at least {_SHORTEST_TOKEN}, for example secrets.token_urlsafe(24)"
                )
        if len(set(tokens.values())) != len(tokens):
            raise ValueError("access_tokens gives two roles the same token; give each its own")
        return tokens

    @field_validator("trusted_proxies")
    @classmethod
    def _proxies_are_addresses(cls, proxies: tuple[str, ...]) -> tuple[str, ...]:
        for proxy in proxies:
            try:
                ipaddress.ip_address(proxy)
            except ValueError:
                raise ValueError(
                    f"trusted_proxies has {proxy!r}; give the proxy's address, for example "
                    "127.0.0.1 (names and networks are not taken)"
                ) from None
        return proxies

    @model_validator(mode="after")
    def _somebody_can_log_in(self) -> Self:
        if not self.access_tokens and self.accounts_file is None:
            raise ValueError("access_tokens is empty and accounts_file is not given; give one")
        return self

    @model_validator(mode="after")
    def _tls_is_whole(self) -> Self:
        if (self.tls_cert is None) != (self.tls_key is None):
            given, missing = (
                ("tls_cert", "tls_key") if self.tls_key is None else ("tls_key", "tls_cert")
            )
            raise ValueError(f"{given} is given without {missing}; give both, or neither")
        return self
