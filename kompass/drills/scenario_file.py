"""Scenarios as YAML files: read strictly, and written the same way every time."""

from __future__ import annotations

import difflib
import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias

import yaml
from pydantic import ValidationError
from pydantic_core import ErrorDetails
from yaml.nodes import MappingNode, Node, ScalarNode

from kompass.drills.scenario import Scenario, parent_model
from kompass.yaml_lines import BadYaml, farthest, line_of, read_yaml

SUFFIXES = (".yaml", ".yml")
_LARGEST = 1_000_000  # bytes of a file; a scenario has some hundreds
_SHOWN = 20  # problems that are told
_VALUE = 80  # characters of a value that are told
_REMEDIES = {
    "missing": ("it is missing", "add it"),
    "float_type": ("that is no number", "give one, without quotation marks"),
    "int_type": ("that is no whole number", "give one, without quotation marks"),
    "string_type": ("that is no text", "put it in quotation marks"),
    "tuple_type": ("that is no list", "give a list: one item a line, each after '- '"),
    "model_type": ("that is no mapping", "give fields and values, as 'x: 1.0'"),
}


class ScenarioProblem(NamedTuple):
    """What is wrong with a scenario, in one place.

    Attributes
    ----------
    where
        File and line.
    field
        As ``faults[0].name``; empty for all of the file.
    value
        What stands there, as JSON; empty when there is nothing.
    text
        What is wrong with it, and what to do.
    """

    where: str
    field: str
    value: str
    text: str

    def __str__(self) -> str:
        field = f" {self.field}" if self.field else ""
        value = f" = {self.value}" if self.value else ""
        return f"{self.where}:{field}{value}{':' if field else ''} {self.text}"


class BadScenario(ValueError):
    """It is no scenario; the message has a line for each thing that is wrong.

    Attributes
    ----------
    problems
        The same, one by one.
    """

    def __init__(self, problems: list[ScenarioProblem]) -> None:
        super().__init__("\n".join(map(str, problems)))
        self.problems = tuple(problems)


def read_scenarios(path: Path) -> tuple[Scenario, ...]:
    """The scenario of a file, or those of all YAML files of a folder, by the names of the files.

    Raises
    ------
    BadScenario
        Something cannot be read, or two scenarios have the same name.
    """
    if not path.is_dir():
        return (read_scenario(path),)
    files = sorted(file for file in path.iterdir() if file.suffix.lower() in SUFFIXES)
    if not files:
        raise _bad(path, "there is no scenario in this folder; put files *.yaml into it")
    found: dict[str, Scenario] = {}
    places: dict[str, Path] = {}
    problems: list[ScenarioProblem] = []
    for file in files:
        try:
            scenario = read_scenario(file)
        except BadScenario as error:
            problems += error.problems
            continue
        if scenario.name in found:
            problems.append(
                ScenarioProblem(
                    str(file),
                    "name",
                    json.dumps(scenario.name, ensure_ascii=False),
                    f"{places[scenario.name].name} has the same name; change one",
                )
            )
        found[scenario.name], places[scenario.name] = scenario, file
    if problems:
        raise BadScenario(problems)
    return tuple(found.values())


def read_scenario(path: Path) -> Scenario:
    """The scenario of a YAML file.

    Raises
    ------
    BadScenario
        It is none; the message names file, line, field, value and remedy.
    """
    try:
        with path.open("rb") as file:
            raw = file.read(_LARGEST + 1)
        if len(raw) > _LARGEST:
            raise _bad(path, f"the file is larger than {_LARGEST} bytes; give a scenario")
        text = raw.decode("utf-8")
    except OSError as error:
        raise _bad(path, f"{error.strerror}; give a YAML file, or a folder of them") from None
    except UnicodeDecodeError as error:
        raise _bad(path, f"byte {error.start} is not UTF-8; give a YAML file") from None
    return parse_scenario(text, str(path))


def parse_scenario(text: str, where: str = "scenario") -> Scenario:
    """The scenario of a YAML text; ``where`` stands before the line in messages.

    Raises
    ------
    BadScenario
        It is none.
    """
    try:
        root, data = read_yaml(text)
    except BadYaml as error:
        raise BadScenario([ScenarioProblem(error.at(where), "", "", str(error))]) from None
    if not isinstance(data, dict):
        problem = "this is no scenario; give a mapping with name, world and goals"
        raise BadScenario([ScenarioProblem(where, "", "", problem)])
    for steps, value in _strange(data, ()):
        node = farthest(root, map(str, steps))
        problem = f"that is a {type(value).__name__}; put it in quotation marks"
        raise BadScenario([ScenarioProblem(_at(where, node), _field(steps), _told(value), problem)])
    try:
        return Scenario.model_validate_json(json.dumps(data))
    except (TypeError, ValueError, RecursionError) as error:
        if isinstance(error, ValidationError):
            raise BadScenario(_problems(where, root, error)) from None
        raise BadScenario([ScenarioProblem(where, "", "", f"{error}; correct it")]) from None


def scenario_text(scenario: Scenario) -> str:
    """A scenario as a YAML file.

    All of it is written, what is at its default too, so that the file still means the same when a
    default has changed.
    """
    data = scenario.model_dump(mode="json", exclude_none=True)
    text: str = yaml.safe_dump(data, sort_keys=False, allow_unicode=True, width=100)
    return text


_Steps: TypeAlias = tuple[str | int, ...]


def _strange(data: Any, steps: _Steps) -> Iterator[tuple[_Steps, Any]]:
    """What YAML reads and JSON does not have, as a date, and where it stands."""
    if isinstance(data, dict):
        for key, value in data.items():
            yield from _strange(value, (*steps, str(key)))
    elif isinstance(data, list):
        for place, value in enumerate(data):
            yield from _strange(value, (*steps, place))
    elif data is not None and not isinstance(data, bool | int | float | str):
        yield steps, data


def _problems(where: str, root: Node | None, error: ValidationError) -> list[ScenarioProblem]:
    found = error.errors(include_url=False)
    # A list whose items are all wrong is called too short besides.
    broken = {item["loc"][:1] for item in found if len(item["loc"]) > 1}
    own = [item for item in found if item["type"] != "too_short" or item["loc"] not in broken]
    return [_problem(where, root, item) for item in own[:_SHOWN]]


def _problem(where: str, root: Node | None, item: ErrorDetails) -> ScenarioProblem:
    steps = tuple(item["loc"])
    kind = item["type"]
    context = item.get("ctx", {})
    if "field" in context:
        field = str(context["field"])
        node = farthest(root, field.replace("[", ".").replace("]", "").split("."))
        value = _told(_plain(node))
    else:
        field = _field(steps)
        node = farthest(root, map(str, steps))
        value = "" if kind == "missing" else _told(item["input"])
    if kind == "extra_forbidden":
        text = _unknown(steps)
    elif kind == "float_type" and _is_figure(node):
        text = "YAML takes that for text; give it a point and a sign, as 1.0e+12"
    elif kind == "string_too_long":
        long, most = len(item["input"]), context["max_length"]
        text = f"that has {long} characters; give at most {most}"
    elif kind in _REMEDIES:
        text = "; ".join(_REMEDIES[kind])
    elif kind.startswith("scenario"):
        text = item["msg"]
    elif kind in ("too_short", "too_long"):
        few, bound = ("few", "min") if kind == "too_short" else ("many", "max")
        limit = f"at {'least' if bound == 'min' else 'most'} {context[f'{bound}_length']}"
        text, value = f"there are too {few}; give {limit}", ""
    else:
        wanted = item["msg"].removeprefix("Input should be ")
        text = f"that is not allowed; give what is {wanted}"
    return ScenarioProblem(_at(where, node), field, value, text)


def _is_figure(node: Node | None) -> bool:
    """Whether what stands there is a number to people, though not to YAML: 1e12."""
    if not isinstance(node, ScalarNode) or node.style is not None:
        return False
    try:
        return math.isfinite(float(node.value))
    except ValueError:
        return False


def _unknown(steps: tuple[str | int, ...]) -> str:
    model = parent_model(steps)
    known = list(model.model_fields) if model else []
    near = difflib.get_close_matches(str(steps[-1]), known, n=1, cutoff=0.6)
    hint = f"did you mean {near[0]!r}? " if near else ""
    return f"there is no such field; {hint}known are {', '.join(known)}"


def _field(steps: tuple[str | int, ...]) -> str:
    return "".join(f"[{s}]" if isinstance(s, int) else f".{s}" for s in steps).removeprefix(".")


def _told(value: Any) -> str:
    text = json.dumps(value, ensure_ascii=True, default=str)
    return text if len(text) <= _VALUE else text[: _VALUE - 1] + "…"


def _plain(node: Node | None) -> Any:
    """What stands at a node, to be shown; structures are shown by nothing but their kind."""
    if isinstance(node, ScalarNode):
        return yaml.safe_load(node.value) if node.style is None else node.value
    if isinstance(node, MappingNode):
        return {str(key.value): _plain(value) for key, value in node.value}
    return None


def _at(where: str, node: Node | None) -> str:
    return where if node is None else f"{where}:{line_of(node)}"


def _bad(path: Path, text: str) -> BadScenario:
    return BadScenario([ScenarioProblem(str(path), "", "", text)])
