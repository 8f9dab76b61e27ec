"""Names of the path-following algorithms."""

import enum


class ControllersID(enum.Enum):
    """Path-following algorithms of the controller."""

    STANLEY = "Stanley"
    PURE_PURSUIT = "PurePursuit"


__all__ = ["ControllersID"]
