"""Read a component's section of a configuration file (yaml, toml or json)."""

import json
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import yaml

COMMON = "/**"


class ConfigFileError(ValueError):
    """The file cannot be used; the message names the file and the remedy."""


def read_config_file(path: str | Path) -> dict[str, Any]:
    """All sections of a file.

    Raises
    ------
    ConfigFileError
        When the file is missing, of another kind, or not well formed.
    """
    path = Path(path)
    readers: dict[str, Callable[[str], Any]] = {
        ".yaml": yaml.safe_load,
        ".yml": yaml.safe_load,
        ".json": json.loads,
        ".toml": tomllib.loads,
    }
    reader = readers.get(path.suffix)
    if reader is None:
        raise ConfigFileError(f"{path}: a configuration file ends in {', '.join(readers)}")
    try:
        content = reader(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise ConfigFileError(f"{path}: there is no such configuration file") from None
    except (OSError, UnicodeDecodeError) as error:
        raise ConfigFileError(f"{path}: cannot be read: {error}") from error
    except (yaml.YAMLError, json.JSONDecodeError, tomllib.TOMLDecodeError) as error:
        detail = " ".join(str(error).split())
        raise ConfigFileError(f"{path}: not well formed: {detail}") from error
    if not isinstance(content, dict):
        raise ConfigFileError(f"{path}: expected sections by node name, found {content!r}")
    return content
