"""Settings of the motion server."""

from pathlib import Path

from pydantic import Field

from kompass.components.base.component_config import ComponentConfig
from kompass.store.paths import robot_folder


class MotionServerConfig(ComponentConfig):
    """What is driven as a test, for how long, and where it is kept."""

    test_period: float = Field(
        default=10.0,
        ge=0.1,
        le=1e3,
        description="s of each leg of a test, 60 at most, and of each recording of a timed one",
    )
    tests_folder: str | None = Field(
        default=None,
        description="where recordings are kept; `motion` in the robot's folder unless given",
    )
    run_step_test: bool = Field(
        default=False, description="a test drives each axis alone, at half of its top speed"
    )
    run_circle_test: bool = Field(
        default=True, description="a test drives arcs, at half of both top speeds"
    )
    most_recordings: int = Field(
        default=100,
        ge=1,
        le=10_000,
        description="files in the folder; the oldest that it named itself go first",
    )

    @property
    def folder(self) -> Path:
        """Where recordings are kept.

        Raises
        ------
        StoreUnwritable
            When the robot has no folder and none is set.
        """
        given = self.tests_folder
        return robot_folder() / "motion" if given is None else Path(given).expanduser().absolute()
