"""Read a table from a JSON or YAML file, and say on which line something is wrong."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

from yaml.nodes import Node, SequenceNode

from kompass.monitor.tables.table_reader import Unreadable, read_table
from kompass.rulebook.schema.report import Finding
from kompass.rules.schema.table import Table
from kompass.yaml_lines import BadYaml, child, farthest, is_scalar, line_of, read_yaml
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
        self._root, data = _read(path, text)
        if isinstance(data, list):
            data = {"rules": data}
            assert self._root is not None
            self._rules: Node | None = self._root
        else:
            self._rules = child(self._root, "rules")
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
            named = (node for node in self._rules.value if is_scalar(child(node, "id"), rule_id))
            at = next(named, self._rules)
        at = farthest(at, re.findall(r"[^.\[\]]+", field))
        return 1 if at is None else line_of(at)


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except OSError as error:
        raise CliError(BAD_INPUT, f"{path}: {error.strerror}; give a JSON or YAML file") from None
    except UnicodeDecodeError as error:
        raise CliError(
            BAD_INPUT, f"{path}: byte {error.start} is not UTF-8; give a JSON or YAML file"
        ) from None


def _read(path: Path, text: str) -> tuple[Node | None, Any]:
    """The file as a tree of nodes with their lines, and as data; JSON is YAML but for its tabs."""
    is_json = path.suffix.lower() == ".json"
    try:
        root, data = read_yaml(text.replace("\t", " ") if is_json else text)
        return root, json.loads(text) if is_json else data
    except BadYaml as error:
        raise CliError(BAD_INPUT, f"{error.at(str(path))}: {error}") from None
    except json.JSONDecodeError as error:
        raise CliError(BAD_INPUT, f"{path}:{error.lineno}: {error.msg}; correct it") from None


def _json(path: Path, data: Any) -> str:
    try:
        return json.dumps(data)
    except (TypeError, ValueError, RecursionError) as error:
        raise CliError(
            BAD_INPUT, f"{path}: {error}; put dates and the like in quotation marks"
        ) from None
