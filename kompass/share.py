"""Files that come with the package: maps, parameters, recipes."""

from importlib.resources import files
from pathlib import Path

from ament_index_python.packages import get_package_share_directory

_PACKAGE = Path(str(files("kompass")))


def map_path(name: str) -> Path:
    """The yaml file of a map that comes with the package."""
    return _PACKAGE / "maps" / f"{name}.yaml"


def recipe_path(name: str) -> Path:
    """A recipe that comes with the package; from the checkout where there is one."""
    checkout = _PACKAGE.parent / "recipes" / name
    if checkout.is_file():
        return checkout
    return Path(get_package_share_directory("kompass")) / "recipes" / name
