"""What can be drilled from this console: the recipe that it was started with, in which world."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Self

from pydantic import BaseModel, ConfigDict

from kompass.drills.scenario import USUAL_ROBOT


class DrillSubject(BaseModel):
    """A recipe as it was when the robot started.

    Attributes
    ----------
    recipe
        Its file, absolute.
    digest
        Of what the file held.
    world
        Of the embedded robot that drives there now; None for a robot of the user's own.
    robot
        Name of that embedded robot, or of one that moves as the user's own.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    recipe: Path
    digest: str
    world: str | None = None
    robot: str = USUAL_ROBOT

    @classmethod
    def of(cls, recipe: Path, world: str | None, robot: str = USUAL_ROBOT) -> Self:
        """A recipe as it is now.

        Raises
        ------
        OSError
            It cannot be read.
        """
        return cls(recipe=recipe.absolute(), digest=_digest(recipe), world=world, robot=robot)

    @property
    def changed(self) -> str:
        """Why a drill would be of another robot than the one that drives; empty if it is not."""
        try:
            same = _digest(self.recipe) == self.digest
        except OSError as error:
            return f"{self.recipe.name} cannot be read any more ({error.strerror})"
        return "" if same else f"{self.recipe.name} was changed since the robot was started"


def _digest(file: Path) -> str:
    return hashlib.sha256(file.read_bytes()).hexdigest()
