"""Control of the robot, as pages are told of it, and as they ask for it."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from kompass_console.control.lease import LONGEST_REASON


class ControlInfo(BaseModel):
    """Who has control of the robot; `holder` is empty when nobody has.

    `holder_key`, `asked_key` and `taken_key` are the `key` of a session. `asked_by` asks for it
    since `asked` seconds. `taken_from` had it before, and `reason` says why it was taken.
    """

    holder: str = ""
    holder_key: str = ""
    asked_by: str = ""
    asked_key: str = ""
    asked: float = 0.0
    taken_from: str = ""
    taken_key: str = ""
    reason: str = ""


class ControlReason(BaseModel):
    """Why control is taken; not needed from nobody, nor from oneself on another device."""

    model_config = ConfigDict(extra="forbid")

    reason: Annotated[str, Field(max_length=LONGEST_REASON)] = ""
