"""Read a table from text that anybody may have sent."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from itertools import islice
from typing import Any

from pydantic import JsonValue, ValidationError

from kompass.half_characters import REMEDY, WHY, Steps, half_characters, may_hold_half
from kompass.invalid import invalid_of
from kompass.rulebook.schema.report import Finding
from kompass.rules.schema.interned import interned_table, text_of
from kompass.rules.schema.signals import path_text
from kompass.rules.schema.table import SAME_ID, Rule, Table

# Beyond these a table is no table of a robot, and reading it would hold up the engine.
MAX_BYTES = 2_000_000
MAX_RULES = 1_000
SHOWN = 50  # findings that are told
_SEVERAL = "several-types"
SHOWN_VALUE = 200  # characters of a value that are told


class Unreadable(ValueError):
    """The text is no table; the message says what is wrong first.

    Attributes
    ----------
    findings
        All that is wrong.
    """

    def __init__(self, findings: Sequence[Finding]) -> None:
        first = findings[0]
        where = f"rule '{first.rule_id}': " if first.rule_id else ""
        field = f"{first.field}: " if first.field else ""
        more = f" (and {len(findings) - 1} more)" if len(findings) > 1 else ""
        super().__init__(f"{where}{field}{first.text}; {first.remedy}{more}")
        self.findings = tuple(findings)


class TableReader:
    """Reads one table after another; a rule that was in the last one is not validated again.

    Rules of the same content are one object (:mod:`kompass.rules.schema.interned`), so that
    what was worked out of a rule is known of it in the next table, too. May be used from any
    thread.
    """

    def __init__(self) -> None:
        self._known: dict[str, Rule] = {}

    def learn(self, table: Table) -> None:
        """Know the rules of a table that was made otherwise, as they will be sent back."""
        rules = interned_table(table).rules
        self._known = {json.dumps(json.loads(text_of(rule))): rule for rule in rules}

    def read(self, text: str) -> Table:
        """Return the table of a JSON text.

        Raises
        ------
        Unreadable
            When it is none, or too large.
        """
        data = _load(text)
        try:
            table = self._validated(data)
        except RecursionError:
            text = "conditions or arguments are nested too deep"
            raise Unreadable([_finding("too-deep", text, "nest them less")]) from None
        except ValidationError as error:
            found = _by_place(error.errors(include_url=False), data)
            raise Unreadable([_of_item(item, data) for item in found[:SHOWN]]) from None
        return table

    def _validated(self, data: Any) -> Table:
        rules = data.get("rules") if isinstance(data, dict) else None
        if not isinstance(rules, list):
            return Table.model_validate(data)
        # By their text, for Python takes 1, 1.0 and True for the same.
        texts = [json.dumps(rule) for rule in rules]
        known = [self._known.get(text, rule) for text, rule in zip(texts, rules, strict=True)]
        try:
            table = Table.model_validate({**data, "rules": known})
        except ValidationError:
            table = Table.model_validate(data)  # complains of what was sent, and of nothing else
        table = interned_table(table)
        self._known = dict(zip(texts, table.rules, strict=True))
        return table


def read_table(text: str) -> Table:
    """Return the table of a JSON text, read by itself.

    Raises
    ------
    Unreadable
        When it is none, or too large.
    """
    return TableReader().read(text)


def _load(text: str) -> Any:
    if len(text) > MAX_BYTES:
        raise Unreadable(
            [
                _finding(
                    "too-large",
                    f"{len(text)} characters are more than {MAX_BYTES}",
                    "send the table alone, with fewer rules",
                )
            ]
        )
    try:
        data = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise Unreadable(
            [_finding("not-json", f"this is not JSON: {error}", "send a table as JSON")]
        ) from None
    rules = data.get("rules") if isinstance(data, dict) else None
    if isinstance(rules, list) and len(rules) > MAX_RULES:
        text = f"{len(rules)} rules are more than {MAX_RULES}"
        raise Unreadable([_finding("too-many", text, "send fewer rules", "rules")])
    broken = list(islice(half_characters(data), SHOWN)) if may_hold_half(text) else ()
    if broken:
        raise Unreadable([_of_broken(path, text, data) for path, text in broken])
    return data


def _of_broken(path: Steps, text: str, data: Any) -> Finding:
    rule = data["rules"][path[1]] if path[:1] == ("rules",) and len(path) > 1 else {}
    named = rule.get("id") if isinstance(rule, dict) else None
    whose = _short(named) if isinstance(named, str) else ""
    return Finding(
        level="error",
        code="malformed",
        rule_id=str(whose)[:100],
        field=path_text(path[2:] if whose else path),
        value=_short(text),
        text=WHY,
        remedy=REMEDY,
    )


def _finding(code: str, text: str, remedy: str, field: str = "", rule_id: str = "") -> Finding:
    return Finding(level="error", code=code, rule_id=rule_id, field=field, text=text, remedy=remedy)


def _by_place(found: Sequence[Any], data: Any) -> list[Any]:
    """One complaint for each value: one that may be of several types has one for each of them."""
    kept: dict[Steps, Any] = {}
    for item in found:
        at, steps = data, []
        for step in item["loc"]:
            if isinstance(at, dict | list) and _has(at, step):
                at = at[step]
                steps.append(step)
            elif not (isinstance(at, dict) and at.get("kind") == step):
                break  # the name of a type, or of what is missing
        place = tuple(steps)
        if item["type"] == "missing" or place == tuple(item["loc"]):
            kept[tuple(item["loc"])] = item
        elif place not in kept:
            kept[place] = item
        elif kept[place]["type"] != _SEVERAL:
            other = {**kept[place], "loc": place, "type": _SEVERAL, "msg": _of_several(at)}
            kept[place] = other
    return list(kept.values())


def _has(at: dict[Any, Any] | list[Any], step: Any) -> bool:
    return step in at if isinstance(at, dict) else isinstance(step, int) and step < len(at)


def _of_several(value: Any) -> str:
    if isinstance(value, float) and not math.isfinite(value):
        return "it must be a finite number"
    return "it fits none of the types that it may be of"


def _of_item(item: Any, data: Any) -> Finding:
    """One complaint of pydantic, in the words of everybody else."""
    path, rule_id, at = "", "", data
    for index, step in enumerate(item["loc"]):
        if isinstance(at, list) and isinstance(step, int) and step < len(at):
            at = at[step]
            path += f"[{step}]"
            if index == 1 and isinstance(at, dict) and isinstance(at.get("id"), str):
                rule_id, path = at["id"][:100], ""
        elif isinstance(at, dict) and step in at:
            at = at[step]
            path += f".{step}" if path else str(step)
        elif not (isinstance(at, dict) and at.get("kind") == step):  # the tag of a union is no step
            path += f".{step}" if path else str(step)
    missing = item["type"] == "missing"
    text, remedy = invalid_of(item).text, "add it" if missing else _remedy(item["type"])
    if item["type"] == SAME_ID:
        path = item["ctx"]["field"]
        text, _, remedy = text.rpartition("; ")
    return Finding(
        level="error",
        code="missing-field" if missing else "malformed",
        rule_id=rule_id,
        field=path,
        # Of the whole there is more than anybody reads.
        value=None if missing or not item["loc"] else _short(item["input"]),
        text=text,
        remedy=remedy,
    )


def _remedy(kind: str) -> str:
    if kind == "extra_forbidden":
        return "leave it out, or correct its name"
    if kind.startswith("union_tag"):
        return "give one of the kinds that are named"
    return "correct the value; the schema of the table says what it may be"


def _short(value: Any) -> JsonValue:
    if value is None or isinstance(value, bool | int):
        return value
    text = value if isinstance(value, str) else repr(value)[: SHOWN_VALUE + 1]
    text = text.encode(errors="replace").decode()  # half of a surrogate pair is no JSON
    return text if len(text) <= SHOWN_VALUE else text[: SHOWN_VALUE - 1] + "…"
