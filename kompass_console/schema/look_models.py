"""What is on the graph besides the stack's own that a page can look at: layers, and cameras."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, Field

ExtraKind = Literal["path", "poses", "markers", "cloud", "scan", "grid", "polygon"]
CameraSize = Literal["small", "large"]

MOST_EXTRAS = 8  # of one page

TopicName = Annotated[str, Field(pattern="^/", max_length=255)]


class ExtraInfo(BaseModel):
    """A topic that can be drawn as a further layer.

    `age` (s) is that of its newest message; null while no page shows it, or none has come.
    `problem` says why it is not drawn, or not all of it; `note` what of it is left out.
    """

    topic: str
    kind: ExtraKind
    age: float | None = None
    problem: str = ""
    note: str = ""


class CameraInfo(BaseModel):
    """A camera; `compressed` is whether it compresses its pictures itself."""

    topic: str
    compressed: bool


class CameraNews(BaseModel):
    """What a page is told that looks at a camera: see `/api/camera`.

    `picture` is a data URL, of a picture that was `width` × `height` pixels before it was made
    small; empty where nothing has changed, or `problem` says why there is none. `age` (s) is that
    of the newest picture; null before the first one.
    """

    type: Literal["camera"] = "camera"
    number: int = 0
    picture: str = ""
    width: int = 0
    height: int = 0
    age: float | None = None
    problem: str = ""
