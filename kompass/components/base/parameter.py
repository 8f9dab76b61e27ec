"""Change settings of a component while it runs: by name, all or nothing."""

import json
from collections.abc import Mapping
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from kompass.settings import Settings, explain, ignored_of, section_of

C = TypeVar("C", bound=Settings)


class ParameterError(ValueError):
    """A setting was refused; the message names it, its value and the remedy."""


def with_values(config: C, values: Mapping[str, Any], where: str = "") -> C:
    """A copy of ``config`` with some fields changed.

    Parameters
    ----------
    values
        By name; a dot leads into a nested model ("map_params.width").
    where
        Prefix of the messages, e.g. the component's name.

    Raises
    ------
    ParameterError
        When any of them is refused; ``config`` itself never changes.
    """
    try:
        return _validate(config, values, where)
    except ValidationError as error:
        raise ParameterError(explain(error, type(config), where)) from None


def read_values(
    config: Settings, texts: Mapping[str, str], where: str = ""
) -> tuple[dict[str, Any], dict[str, str]]:
    """Typed values of texts as they travel in the services, and what is wrong with the others.

    A text is JSON, or else plain: ``0.3``, ``[1, 2]``, ``null``, ``True``, ``Stanley``. The type of
    the field decides; "False" is false for a truth value.

    Returns
    -------
    tuple[dict, dict]
        Accepted values, and messages of refused ones, both by name.
    """
    values: dict[str, Any] = {name: _from_json(text) for name, text in texts.items()}
    refused = _refused(config, values, where)
    # What is no JSON of the right type may still be the very text: a name that reads as a number.
    plain = {name: texts[name] for name in refused if values[name] != texts[name]}
    if plain:
        values |= plain
        again = _refused(config, values, where)
        refused = {name: refused.get(name, text) for name, text in again.items()}
    return {name: value for name, value in values.items() if name not in refused}, refused


def _refused(config: Settings, values: Mapping[str, Any], where: str) -> dict[str, str]:
    """What is wrong with values by name, taken together: one may only be possible with another."""
    try:
        _validate(config, values, where)
    except ParameterError as error:
        return {name: str(error) for name in values if repr(name) in str(error)}
    except ValidationError as error:
        refused: dict[str, str] = {}
        lines = explain(error, type(config), where).splitlines()
        for item, line in zip(error.errors(), lines, strict=False):
            path = ".".join(str(part) for part in item["loc"])
            named = [name for name in values if f"{path}.".startswith(f"{name}.")]
            # A rule between fields belongs to none of them.
            for name in named or values:
                refused.setdefault(name, line)
        return refused
    return {}


def _validate(config: C, values: Mapping[str, Any], where: str) -> C:
    plain = config.model_dump()
    for name, value in values.items():
        _refuse_ignored(type(config), name, value, where)
        _set(plain, name, value, where)
    return type(config).model_validate(plain)


def _refuse_ignored(model: type[BaseModel], name: str, value: Any, where: str) -> None:
    """Who writes a file for several stacks is told; who changes one setting wants an effect."""
    *path, last = name.split(".")
    for part in path:
        section = section_of(model, part)
        if section is None:
            return
        model = section
    why = ignored_of(model).get(last)
    if why is not None:
        prefix = f"{where}: " if where else ""
        raise ParameterError(f"{prefix}{name!r} = {value!r} would have no effect: {why}")


def _from_json(text: str) -> Any:
    try:
        return json.loads(text)
    except json.JSONDecodeError:
        return text


def _set(plain: dict[str, Any], name: str, value: Any, where: str) -> None:
    *path, last = name.split(".")
    inner: Any = plain
    for depth, part in enumerate(path):
        inner = inner.get(part) if isinstance(inner, dict) else None
        if not isinstance(inner, dict):
            prefix = f"{where}: " if where else ""
            if inner is None and ".".join(path[: depth + 1]) in plain:
                raise ParameterError(
                    f"{prefix}'{name}' = {value!r}: nobody gave '{part}' yet; give it whole"
                )
            known = ", ".join(key for key, held in plain.items() if isinstance(held, dict))
            raise ParameterError(
                f"{prefix}'{name}' = {value!r}: '{'.'.join(path[: depth + 1])}' holds no settings; "
                f"those that do are {known}"
            )
    inner[last] = value
