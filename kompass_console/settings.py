"""What the console is told by whoever starts it."""

from __future__ import annotations

from pathlib import Path

from pydantic import BaseModel, ConfigDict, Field, field_validator

from kompass_console.schema.models import Theme
from kompass_console.schema.roles import Role

_SHORTEST_TOKEN = 16


class TopicOverrides(BaseModel):
    """Topic names to read instead of those found on the ROS graph (None: look for one)."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    odometry: str | None = None
    scan: str | None = None
    map: str | None = None
    local_map: str | None = None
    plan: str | None = None


class ConsoleSettings(BaseModel):
    """Settings of one console; unknown names are errors.

    Attributes
    ----------
    access_tokens
        The secret of each role that may log in.
    allow_hosts
        Names that a browser may use in the address bar besides loopback names and literal
        addresses.
    audit_folder
        Where the audit log is kept; None where it cannot be, which people are told.
    recordings
        Folder of the robot's recordings; None where it is not on this machine.
    domain_id
        None for the environment's ROS_DOMAIN_ID.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    robot_name: str = "robot"
    access_tokens: dict[Role, str] = Field(min_length=1)
    theme: Theme = "light"
    topics: TopicOverrides = TopicOverrides()
    allow_hosts: tuple[str, ...] = ()
    audit_folder: Path | None = None
    recordings: Path | None = None
    domain_id: int | None = Field(default=None, ge=0, le=232)
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
