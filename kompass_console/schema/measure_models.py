"""The contract of measuring: points that a person presses on the floor."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, Field

from kompass_console.schema.models import In, Metres, OnPicture

MOST_POINTS = 100
_Point = Annotated[tuple[Metres, Metres], Field(strict=False)]  # a list in JSON


class MeasureSketch(In):
    """Points that were pressed before, in the map frame (m), and what the hand has done last.

    `start` and `end` are fractions of the picture of `view`: a press adds a point; a drag its
    beginning and its end where there is no point yet, else its end.
    """

    view: Annotated[str, Field(max_length=64)]
    points: Annotated[list[_Point], Field(max_length=MOST_POINTS)]
    start: OnPicture | None = None
    end: OnPicture | None = None


class MeasuredPoints(BaseModel):
    """The points with those that were added; `problem` says why none was; empty when all is
    well."""

    points: list[tuple[float, float]]
    problem: str
