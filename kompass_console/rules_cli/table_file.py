"""Read a table from a JSON or YAML file, and say on which line something is wrong."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import yaml
from yaml.nodes import MappingNode, Node, ScalarNode, SequenceNode

from kompass.monitor.tables.table_reader import Unreadable, read_table
from kompass.rulebook.schema.report import Finding
from kompass.rules.schema.table import Table
from kompass_console.cli_error import CliError

BAD_INPUT = 2


class TableFile:
    """A table, and where in its file each part of it stands.

    Attributes
    ----------
    table
        What the file holds.
    path
        Of the file.
    """

    def __init__(self, path: Path) -> None:
        """Read a file: a mapping with ``rules``, or a list of rules.

        Raises
        ------
        CliError
            Naming file, line, rule, field, value and remedy of everything that is wrong.
        """
        self.path = path
        text = _text(path)
        self._root = _compose(path, text)
        data = _data(path, text)
        if isinstance(data, list):
            data = {"rules": data}
            assert self._root is not None
            self._rules: Node | None = self._root
        else:
            self._rules = _child(self._root, "rules")
        if not isinstance(data, dict) or "rules" not in data:
            raise CliError(
                BAD_INPUT,
                f"{path}: this is no table of rules; give a mapping with 'rules:', as "
                "'kompass-console rules export' writes it",
            )
        try:
            self.table: Table = read_table(_json(path, data))
        except Unreadable as error:
            lines = [self.locate(finding) for finding in error.findings]
            raise CliError(BAD_INPUT, "\n  ".join(lines)) from None

    def locate(self, finding: Finding) -> str:
        """A finding in one line, with its place in the file."""
        where = f"{self.path}:{self.line(finding.rule_id, finding.field)}"
        rule = f" rule '{finding.rule_id}':" if finding.rule_id else ""
        field = f" {finding.field}" if finding.field else ""
        value = f" = {json.dumps(finding.value, ensure_ascii=False)}" if finding.value else ""
        colon = ":" if field or value else ""
        return f"{where}:{rule}{field}{value}{colon} {finding.text}; {finding.remedy}"

    def line(self, rule_id: str, field: str) -> int:
        """Number of the line on which a field of a rule stands, or what there is of its way."""
        at = self._rules if rule_id else self._root
        if rule_id and isinstance(self._rules, SequenceNode):
            named = (node for node in self._rules.value if _is(_child(node, "id"), rule_id))
            at = next(named, self._rules)
        for step in re.findall(r"[^.\[\]]+", field):
            inner = _child(at, step)
            if inner is None:
                break
            at = inner
        return at.start_mark.line + 1 if at is not None else 1


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except OSError as error:
        raise CliError(BAD_INPUT, f"{path}: {error.strerror}; give a JSON or YAML file") from None
    except UnicodeDecodeError as error:
        raise CliError(
            BAD_INPUT, f"{path}: byte {error.start} is not UTF-8; give a JSON or YAML file"
        ) from None


def _compose(path: Path, text: str) -> Node | None:
    """The file as a tree of nodes with their lines; JSON is YAML but for its tabs."""
    loader = yaml.SafeLoader(text.replace("\t", " ") if _is_json(path) else text)
    try:
        root: Node | None = loader.get_single_node()
        if root is not None:
            _refuse_doubles(path, root)
        return root
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line = mark.line + 1 if mark else 1
        raise CliError(BAD_INPUT, f"{path}:{line}: {error.problem or error}; correct it") from None
    except (yaml.YAMLError, RecursionError) as error:
        raise CliError(BAD_INPUT, f"{path}: {' '.join(str(error).split())}") from None
    finally:
        loader.dispose()


def _refuse_doubles(path: Path, node: Node) -> None:
    """A key given twice would silently win over the first."""
    if isinstance(node, MappingNode):
        seen: set[str] = set()
        for key, value in node.value:
            if isinstance(key, ScalarNode) and key.value in seen:
                raise CliError(
                    BAD_INPUT,
                    f"{path}:{key.start_mark.line + 1}: '{key.value}' is given twice; keep one",
                )
            seen.add(key.value if isinstance(key, ScalarNode) else "")
            _refuse_doubles(path, value)
    elif isinstance(node, SequenceNode):
        for item in node.value:
            _refuse_doubles(path, item)


def _data(path: Path, text: str) -> Any:
    if not _is_json(path):
        return yaml.safe_load(text)
    try:
        return json.loads(text)
    except json.JSONDecodeError as error:
        raise CliError(BAD_INPUT, f"{path}:{error.lineno}: {error.msg}; correct it") from None


def _json(path: Path, data: Any) -> str:
    try:
        return json.dumps(data)
    except (TypeError, ValueError, RecursionError) as error:
        raise CliError(
            BAD_INPUT, f"{path}: {error}; put dates and the like in quotation marks"
        ) from None


def _is_json(path: Path) -> bool:
    return path.suffix.lower() == ".json"


def _child(node: Node | None, step: str) -> Node | None:
    if isinstance(node, MappingNode):
        return next((value for key, value in node.value if _is(key, step)), None)
    if isinstance(node, SequenceNode) and step.isdigit() and int(step) < len(node.value):
        found: Node = node.value[int(step)]
        return found
    return None


def _is(node: Node | None, value: str) -> bool:
    return isinstance(node, ScalarNode) and node.value == value
