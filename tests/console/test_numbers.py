"""Whatever number a request has, it is answered: one that is none is the caller's fault."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from typing import Any

import pytest

from kompass_console.api.app import create_app, openapi
from kompass_console.schema.roles import Role
from tests.console.conftest import Served

SCHEMA = openapi(create_app(None))
NO_NUMBER = "1e400"  # JSON has it, and a float has not
# Read as text, and checked by the monitor with all that is in it.
AS_TEXT = {"Table"}

Schema = dict[str, Any]


def resolved(schema: Schema) -> Schema:
    while "$ref" in schema:
        schema = SCHEMA["components"]["schemas"][schema["$ref"].rpartition("/")[2]]
    return schema


def is_text(schema: Schema) -> bool:
    return schema.get("$ref", "").rpartition("/")[2] in AS_TEXT


def choices(schema: Schema) -> list[Schema]:
    return schema.get("anyOf") or schema.get("oneOf") or []


def plain(schema: Schema) -> Any:
    """A value that may stand there."""
    if is_text(schema):
        return {"rules": []}
    schema = resolved(schema)
    if choices(schema):
        return plain(choices(schema)[0])
    if "const" in schema or "enum" in schema:
        return schema.get("const", schema.get("enum", [None])[0])
    match schema.get("type"):
        case "object":
            fields = schema.get("properties", {})
            return {name: plain(fields[name]) for name in schema.get("required", [])}
        case "array":
            items = schema.get("prefixItems") or [schema.get("items", {})] * schema.get(
                "minItems", 0
            )
            return [plain(each) for each in items]
        case "number" | "integer":
            return max(0, schema.get("minimum", 0))
        case "boolean":
            return False
        case "null":
            return None
    return "a" * max(1, schema.get("minLength", 1))


def spoilt(schema: Schema, above: tuple[str, ...] = ()) -> Iterator[Any]:
    """Values that may stand there, each with one number that is none."""
    name = schema.get("$ref", "")
    if is_text(schema) or name in above:
        return
    above = (*above, name) if name else above
    schema = resolved(schema)
    for choice in choices(schema):
        yield from spoilt(choice, above)
    match schema.get("type"):
        case "number" | "integer":
            yield math.inf
        case "object":
            for field, inner in schema.get("properties", {}).items():
                for value in spoilt(inner, above):
                    yield plain(schema) | {field: value}
        case "array":
            items = schema.get("prefixItems")
            if items is None:
                others = plain(schema)[1:]
                yield from ([value, *others] for value in spoilt(schema.get("items", {}), above))
                return
            for index, inner in enumerate(items):
                for value in spoilt(inner, above):
                    yield [value if at == index else plain(e) for at, e in enumerate(items)]


def requests() -> Iterator[tuple[str, str, dict[str, str], str]]:
    """Method, path, query and body of each."""
    for path, methods in SCHEMA["paths"].items():
        for method, operation in methods.items():
            parameters = operation.get("parameters", [])
            queries = {each["name"]: each for each in parameters if each["in"] == "query"}
            paths = {each["name"]: each for each in parameters if each["in"] == "path"}
            filled = path
            for name, each in paths.items():
                filled = filled.replace(f"{{{name}}}", str(plain(each["schema"])))
                if resolved(each["schema"]).get("type") in ("number", "integer"):
                    yield method, path.replace(f"{{{name}}}", NO_NUMBER), {}, "{}"
            needed = {
                name: str(plain(each["schema"]))
                for name, each in queries.items()
                if each.get("required")
            }
            for name, each in queries.items():
                if any(value == math.inf for value in spoilt(each["schema"])):
                    yield method, filled, needed | {name: NO_NUMBER}, "{}"
            for content in operation.get("requestBody", {}).get("content", {}).values():
                for body in spoilt(content["schema"]):
                    text = json.dumps(body).replace("Infinity", NO_NUMBER)
                    yield method, filled, needed, text


REQUESTS = list(requests())


def test_all_that_takes_a_number_is_tried() -> None:
    tried = {(method, path) for method, path, _, _ in REQUESTS}
    assert {
        ("post", "/api/goals"),
        ("post", "/api/timeline/alarms/acknowledge"),
        ("get", "/api/timeline"),
        ("post", "/api/zones"),
        ("post", "/api/missions"),
        ("post", "/api/backtests"),
    } <= tried
    assert len(REQUESTS) > 60


@pytest.mark.ros
def test_a_number_that_is_none_is_the_callers_fault_wherever_it_stands(console: Served) -> None:
    wrong = []
    with console.client(Role.ENGINEER) as client:
        for method, path, query, body in REQUESTS:
            answer = client.request(
                method,
                path,
                params=query,
                content=body,
                headers={"Content-Type": "application/json"},
            )
            if not 400 <= answer.status_code < 500:
                wrong.append(f"{method} {path} {query} {body}: {answer.status_code}")
            else:
                assert answer.json()["detail"]["title"]
    assert not wrong, "\n".join(wrong)
