"""The zones that were heard last, on disk: in force from the first moment of the next start on."""

from pathlib import Path

from pydantic import ValidationError

from kompass.store.durable import write_whole
from kompass.store.paths import safe_name
from kompass.zones.zone import ZonesNow


def zones_path(folder: Path, node_name: str) -> Path:
    """Where a drive manager keeps the zones in the folder of its robot."""
    return folder / f"zones-{safe_name(node_name)}.json"


def load_zones(path: Path) -> ZonesNow | None:
    """What was in force last; None where nothing was kept.

    Raises
    ------
    ValueError
        It cannot be read; the message says why.
    """
    try:
        return ZonesNow.model_validate_json(path.read_bytes())
    except (FileNotFoundError, NotADirectoryError):
        return None
    except OSError as error:
        raise ValueError(f"{path} cannot be read: {error.strerror}") from None
    except ValidationError:
        raise ValueError(f"{path} is damaged") from None


def keep_zones(path: Path, zones: ZonesNow) -> None:
    """Bring zones to the disk; what has the name is always complete.

    Raises
    ------
    OSError
        The disk cannot be written.
    """
    path.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
    write_whole(path, zones.model_dump_json().encode())
