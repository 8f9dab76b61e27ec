"""Names of the path-following algorithms."""

import enum

# What other releases of the recipes' API offer besides.
ELSEWHERE = {
    "DVZ": "DVZ",
    "VISION_IMG": "VisionRGBFollower",
    "VISION_DEPTH": "VisionRGBDFollower",
}


class _Named(enum.EnumMeta):
    def __getattr__(cls, name: str) -> object:
        if name in ELSEWHERE:
            raise AttributeError(
                f"{cls.__name__}.{name} is not offered here; choose "
                f"{', '.join(f'{cls.__name__}.{known}' for known in cls.__members__)}"
            )
        raise AttributeError(f"{cls.__name__} has no '{name}'")


class ControllersID(enum.Enum, metaclass=_Named):
    """Path-following algorithms of the controller."""

    STANLEY = "Stanley"
    PURE_PURSUIT = "PurePursuit"
    DWA = "DWA"
    MPPI = "MPPI"

    @classmethod
    def _missing_(cls, value: object) -> "ControllersID | None":
        if value in ELSEWHERE or value in ELSEWHERE.values():
            known = ", ".join(member.value for member in cls)
            raise ValueError(f"the algorithm {value!r} is not offered here; choose {known}")
        return None
