"""Settings of components that keep to the masks of the recipe."""

from pydantic import Field

from kompass.components.base.robot_limits import velocity_limits
from kompass.components.base.sensor_settings import SensorSettings
from kompass.zones.mask import Mask, MaskInForce
from kompass.zones.zone import FASTEST

MOST_MASKS = 20


class MaskSettings(SensorSettings):
    """What of the floor is forbidden by images."""

    masks: tuple[Mask, ...] = Field(
        default=(),
        max_length=MOST_MASKS,
        description="images of where the robot must not be, or is slower; all of them count",
    )

    def masks_in_force(self) -> list[MaskInForce]:
        """What they forbid this robot."""
        if self.robot is None:
            return [mask.in_force(FASTEST) for mask in self.masks]
        limits = velocity_limits(self.robot)
        top = max(limits.vx.max_vel, limits.vy.max_vel)
        return [mask.in_force(top) for mask in self.masks]
