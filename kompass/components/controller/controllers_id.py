"""Names of the algorithms of the controller."""

import enum


class ControllersID(enum.Enum):
    """Algorithms of the controller: those that follow a path, and two that follow a target."""

    STANLEY = "Stanley"
    PURE_PURSUIT = "PurePursuit"
    DWA = "DWA"
    DVZ = "DVZ"
    MPPI = "MPPI"
    VISION_IMG = "VisionRGBFollower"
    VISION_DEPTH = "VisionRGBDFollower"

    @property
    def sees_target(self) -> bool:
        """Whether it follows what a camera sees, and no path."""
        return self in (ControllersID.VISION_IMG, ControllersID.VISION_DEPTH)


FOLLOWERS_OF_PATHS = tuple(each for each in ControllersID if not each.sees_target)
