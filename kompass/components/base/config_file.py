"""Read a component's section of a configuration file (yaml, toml or json)."""

import copy
import difflib
import json
import tomllib
from collections.abc import Callable, Collection, Mapping
from pathlib import Path
from typing import Any, TypeVar

from pydantic import ValidationError

from kompass.json_once import GivenTwice, read_json
from kompass.rclpy_ext.topic import AllowedTopics, Topic
from kompass.settings import Settings, explain, notice_once, without_ignored
from kompass.yaml_lines import BadYaml, read_yaml

COMMON = "/**"
C = TypeVar("C", bound=Settings)
# By direction ("inputs", "outputs") and key.
ConfiguredTopics = dict[str, dict[str, Topic]]


class ConfigFileError(ValueError):
    """The file cannot be used; the message names the file and the remedy."""


def check_path(name: str, value: object) -> None:
    """Raise what is wrong with a value that is to be the path of a file.

    Raises
    ------
    TypeError
        When it is none.
    """
    if not isinstance(value, str | Path) or not str(value):
        raise TypeError(f"{name} = {value!r} is no path; give that of a yaml, toml or json file")


def read_config_file(path: str | Path) -> dict[str, Any]:
    """All sections of a file.

    Raises
    ------
    ConfigFileError
        When the file is missing, of another kind, or not well formed.
    TypeError
        When ``path`` is none.
    """
    check_path("config_file", path)
    path = Path(path)
    readers: dict[str, Callable[[str], Any]] = {
        ".yaml": _yaml,
        ".yml": _yaml,
        ".json": read_json,
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
    except BadYaml as error:
        raise ConfigFileError(f"{error.at(str(path))}: {error}") from None
    except RecursionError:
        raise ConfigFileError(
            f"{path}: it is nested too deeply to be read; write it with fewer levels"
        ) from None
    except (GivenTwice, json.JSONDecodeError, tomllib.TOMLDecodeError) as error:
        detail = " ".join(str(error).split())
        raise ConfigFileError(f"{path}: not well formed: {detail}") from error
    if not isinstance(content, dict):
        raise ConfigFileError(f"{path}: expected sections by node name, found {content!r}")
    for section in content:
        if not isinstance(section, str):
            raise ConfigFileError(
                f"{path}: the section {section!r} is no name of a node; write '{COMMON}' for all, "
                "or a component's name"
            )
    return content


def _yaml(text: str) -> Any:
    return read_yaml(text)[1]


def sections_of_nobody(
    path: str, names: Collection[str], settings: Collection[str] = ()
) -> list[str]:
    """A sentence for each section of a file that is for none of the nodes ``names``.

    Of what stands in the section for all there is one for each key that is none of ``settings``,
    those of any of the nodes; without any, nobody is asked.

    Raises
    ------
    ConfigFileError
        When the file cannot be used.
    """
    told: list[str] = []
    for section, values in read_config_file(path).items():
        if section == COMMON and settings and isinstance(values, dict):
            for key in (key for key in values if key not in settings):
                close = difflib.get_close_matches(str(key), settings, n=1)
                hint = f"; did you mean '{close[0]}'?" if close else ""
                told.append(f"{path}: no component has '{key}' of the section '{COMMON}'{hint}")
        elif section != COMMON and section not in names:
            close = difflib.get_close_matches(section, names, n=1)
            remedy = f"did you mean '{close[0]}'?" if close else f"there are {', '.join(names)}"
            told.append(f"{path}: the section '{section}' is for no component; {remedy}")
    return told


def settings_of_file(
    path: str,
    node_name: str,
    config: C,
    allowed: Mapping[str, Mapping[str, AllowedTopics]],
    *,
    ignored_settings: Mapping[str, str],
    ignored_inputs: Mapping[str, str],
) -> tuple[C, ConfiguredTopics]:
    """The settings and topics of a component after a file was laid over them; changes nothing.

    Parameters
    ----------
    node_name
        Name of the component's own section; the section ``/**`` comes before it, and what in there
        is unknown to the component is meant for others.
    config
        Settings before.
    allowed
        What keys of ``inputs`` and of ``outputs`` take.
    ignored_settings, ignored_inputs
        Keys that are told once and have no effect, with the reason.

    Raises
    ------
    ConfigFileError
        When the file or a setting in it cannot be used.
    """
    sections = read_config_file(path)
    settings = config.model_dump()
    topics: ConfiguredTopics = {"inputs": {}, "outputs": {}}
    for name in (COMMON, node_name):
        section = sections.get(name) or {}
        where = f"{path}, section '{name}'"
        if not isinstance(section, dict):
            raise ConfigFileError(f"{where}: expected settings, found {section!r}")
        for key, value in without_ignored(type(config), section, where).items():
            if key in topics:
                ignored = ignored_inputs if key == "inputs" else {}
                at = f"{where}, {key}"
                topics[key].update(
                    _read_topics(node_name, value, allowed[key], ignored, at, name == COMMON)
                )
            elif key in ignored_settings:
                notice_once(f"{where}: '{key}' is ignored: {ignored_settings[key]}")
            elif key in settings or name != COMMON:
                _lay_over(settings, key, value)
    try:
        updated = type(config).model_validate(settings)
    except ValidationError as error:
        raise ConfigFileError(explain(error, type(config), path)) from None
    return updated, topics


def _read_topics(
    node_name: str,
    given: Mapping[str, Any],
    allowed: Mapping[str, AllowedTopics],
    ignored: Mapping[str, str],
    where: str,
    common: bool,
) -> dict[str, Topic]:
    read = {}
    for key, fields in given.items():
        if common and key not in allowed:
            continue
        if key in ignored:
            notice_once(f"{where}.{key} is ignored: {ignored[key]}")
            continue
        try:
            if key not in allowed:
                raise ValueError(f"no such key; known are {', '.join(allowed)}")
            read[key] = Topic(**fields)
            allowed[key].check(node_name, key, [read[key]])
        except (TypeError, ValueError) as error:
            raise ConfigFileError(f"{where}.{key}: {error}") from None
    return read


def _lay_over(config: dict[str, Any], key: str, value: Any) -> None:
    if isinstance(value, dict) and isinstance(config.get(key), dict):
        for inner, inner_value in value.items():
            _lay_over(config[key], inner, inner_value)
    else:
        config[key] = copy.deepcopy(value)
