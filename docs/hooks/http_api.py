"""The HTTP API, from the schema that the page is typed against, and the websockets beside it."""

from __future__ import annotations

import json
import sys
from collections import defaultdict
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from fastapi.routing import APIWebSocketRoute

from docs.hooks.markup import code, prose, summary, table
from kompass_console.api.app import create_app

INTRODUCTION = """# HTTP and WebSocket

What the page talks to. `GET /api/openapi.json` of a running console is the same as a schema, for
whoever is logged in. Every error is `{"detail": {"title": …, "remedy": …}}`: what and why, and
what to do about it.

**Logging in.** `POST /api/login` with `{"token": "…"}` answers with a cookie, valid for seven
days or until the console's tokens change. A role may do what the ones before it may: `viewer`
(watch, and STOP), `operator`, `engineer`.

**Host and Origin.** The console answers to `localhost`, this machine's name (with and without
`.local`) and literal addresses; any other `Host` gets 421. Everything but `GET` and `HEAD`, and
every websocket, must carry an `Origin` header with the same host and port as `Host`, else it
gets 403 (close code 4403). A script sets it itself.
"""
SOCKETS = """## WebSockets

What is written as code is described under [Shapes](#shapes). A slow reader gets fewer messages,
never a queue of old ones. Close codes: 4401 not logged in, 4403 not allowed.
"""
METHODS = ("get", "post", "patch", "delete")


def http_page(schema_file: Path) -> str:
    """Routes by topic, then the shape of everything that is sent."""
    schema = json.loads(schema_file.read_text(encoding="utf-8"))
    models: dict[str, Any] = schema["components"]["schemas"]
    routes: dict[str, list[tuple[str, str, dict[str, Any]]]] = defaultdict(list)
    for path, methods in schema["paths"].items():
        for method in METHODS:
            if method in methods:
                routes[methods[method]["tags"][0]].append((method, path, methods[method]))
    parts = [INTRODUCTION]
    for tag, listed in routes.items():
        parts.append(f"## {tag.capitalize()}\n")
        parts += [_route(*route) for route in listed]
    parts += [SOCKETS, _sockets(), "## Shapes\n"]
    parts += [_model(name, model) for name, model in models.items()]
    return "\n".join(parts)


def _sockets() -> str:
    """The websockets of the application, as their modules and functions tell of them."""
    rows = [
        (
            code(route.path),
            prose(f"{summary(sys.modules[route.endpoint.__module__])} {summary(route.endpoint)}"),
        )
        for route in websockets(create_app(None).routes)
    ]
    return table(("path", "what it says"), sorted(rows))


def websockets(routes: Iterable[Any]) -> Iterator[Any]:
    """Websockets of the API, also those of routers that are included; not that of the scene."""
    for route in routes:
        inner = getattr(route, "original_router", None) or getattr(route, "routes", None)
        if inner is not None:
            yield from websockets(getattr(inner, "routes", inner))
        elif isinstance(route, APIWebSocketRoute) and route.path.startswith("/api/"):
            yield route


def _route(method: str, path: str, route: dict[str, Any]) -> str:
    lines = [f"### `{method.upper()} {path}`\n", prose(route.get("description", "")) + "\n"]
    given = route.get("parameters", [])
    if given:
        rows = [
            (
                code(one["name"]),
                one["in"],
                shape(one["schema"]),
                "required" if one.get("required") else _default(one["schema"]),
            )
            for one in given
        ]
        lines.append(table(("parameter", "in", "type", "default"), rows))
    body = _content(route.get("requestBody", {}))
    if body:
        lines.append(f"Body: {body}\n")
    for status, answer in route["responses"].items():
        if status.startswith("2"):
            lines.append(f"Answer: {status}, {_content(answer) or 'nothing'}\n")
    return "\n".join(lines)


def _content(holder: dict[str, Any]) -> str:
    for media, content in holder.get("content", {}).items():
        what = shape(content.get("schema", {}))
        return what if media == "application/json" and what else f"{code(media)} {what}".strip()
    return ""


def _model(name: str, model: dict[str, Any]) -> str:
    lines = [f"### {name}\n"]
    if model.get("description"):
        lines.append(prose(_first(model["description"])) + "\n")
    if "enum" in model:
        lines.append("One of " + ", ".join(code(value) for value in model["enum"]) + ".\n")
    required = model.get("required", [])
    rows = [
        (
            code(field),
            shape(of),
            "required" if field in required else _default(of),
            prose(of.get("description", "")),
        )
        for field, of in model.get("properties", {}).items()
    ]
    if rows:
        lines.append(table(("field", "type", "default", "what it is"), rows))
    return "\n".join(lines)


def _first(text: str) -> str:
    kept = []
    for block in text.split("\n\n"):
        if block.startswith("Attributes"):
            break
        kept.append(" ".join(block.split()))
    return "\n\n".join(kept)


def shape(of: dict[str, Any]) -> str:
    """A JSON schema in a few words; models as links."""
    if "$ref" in of:
        name = of["$ref"].rpartition("/")[2]
        return f"[{name}](#{name.lower()})"
    for union in ("anyOf", "oneOf", "allOf"):
        if union in of:
            return " or ".join(dict.fromkeys(shape(one) for one in of[union]))
    if "const" in of:
        return code(json.dumps(of["const"]))
    if "enum" in of:
        return ", ".join(code(value) for value in of["enum"])
    kind = of.get("type", "")
    if kind == "array":
        return f"list of {shape(of.get('items', {})) or 'anything'}"
    if kind == "object" and isinstance(of.get("additionalProperties"), dict):
        return f"mapping to {shape(of['additionalProperties']) or 'anything'}"
    return {"null": "none", "string": "text", "integer": "whole number"}.get(kind, kind) or "any"


def _default(of: dict[str, Any]) -> str:
    return code(json.dumps(of["default"])) if "default" in of else ""
