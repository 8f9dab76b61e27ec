"""The command line, from the definitions of its commands."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any, Literal, get_args, get_origin

import typer.main

from docs.hooks.markup import cell, code, table
from kompass_console.cli import app

INTRODUCTION = """# Command line

`kompass-console` is in the environment's `bin` folder: `.venv/bin/kompass-console` in a
checkout. `--help` after any command says the same as this page.
"""


def command_line_page() -> str:
    """Each command with its arguments and options."""
    root = typer.main.get_command(app)
    parts = [INTRODUCTION]
    parts.append(_epilog(root))
    for name, command in _commands(root, "kompass-console"):
        parts += [f"## {name}\n", (command.help or "").strip() + "\n"]
        if hasattr(command, "commands"):
            parts.append(_epilog(command))
            if not command.invoke_without_command:
                continue
        rows = [row for one in command.params if (row := _row(one)) is not None]
        if rows:
            parts.append(table(("argument or option", "value", "default", "what it does"), rows))
    return "\n".join(parts)


def _commands(group: Any, before: str) -> Iterator[tuple[str, Any]]:
    for name, command in group.commands.items():
        yield f"{before} {name}", command
        if hasattr(command, "commands"):
            yield from _commands(command, f"{before} {name}")


def _row(parameter: Any) -> tuple[str, str, str, str] | None:
    if "--help" in parameter.opts:
        return None
    is_option = parameter.param_type_name == "option"
    opts = parameter.opts if is_option else [parameter.metavar or parameter.name.upper()]
    names = ", ".join(code(name) for name in opts)
    flag = is_option and parameter.is_flag
    default = parameter.default
    shown = "" if default in (None, False, "") or callable(default) else code(default)
    if parameter.required:
        shown = "required"
    value = "" if flag else _value(parameter)
    return names, value, shown, parameter.help or ""


def _value(parameter: Any) -> str:
    """What a value may be; the name that an option gives it, where it gives one."""
    if parameter.param_type_name == "option" and parameter.metavar:
        return str(cell(parameter.metavar))
    kind = parameter.type_descriptor.annotation
    if get_origin(kind) is Literal:
        return ", ".join(code(one) for one in get_args(kind))
    if get_origin(kind) is list:
        return "several"
    low, high = parameter.min, parameter.max
    if low is not None:
        return f"{low:g} to {high:g}" if high is not None else f"≥ {low:g}"
    return {str: "text", int: "whole number", float: "number", Path: "file or folder"}.get(kind, "")


def _epilog(group: Any) -> str:
    return "\n".join(line.strip() for line in (group.epilog or "").strip().splitlines()) + "\n"
