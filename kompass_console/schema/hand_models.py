"""What a page and the console say to each other while somebody drives by hand."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, Field

from kompass_console.schema.models import In

Number = Annotated[float, Field(allow_inf_nan=False, ge=-1e6, le=1e6)]


class HandRequest(In):
    """What the page sends on `/api/hand`.

    `drive` is the hand as it is now, every 50 ms while the page has the wheel: a twist (m/s, m/s,
    rad/s), and the page's own clock (`t`, s), which tells how long it was under way.
    """

    type: Literal["take", "take over", "give", "ask", "drive"]
    t: Annotated[float, Field(allow_inf_nan=False)] = 0.0
    vx: Number = 0.0
    vy: Number = 0.0
    omega: Number = 0.0


class HandAnswer(BaseModel):
    """Message of `/api/hand`: whether this page has the wheel.

    The limits are the robot's (m/s, m/s, rad/s), and 0 while the page has not. `message` says why
    it has not got it, or has it no more; it is empty when there is nothing to say. `asked_by` is
    who asks for the wheel.
    """

    type: Literal["hand"] = "hand"
    yours: bool
    max_vx: float = 0.0
    max_vy: float = 0.0
    max_omega: float = 0.0
    message: str = ""
    asked_by: str = ""
