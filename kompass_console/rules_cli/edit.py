"""Commands that change a rule or two without a file: set, enable, disable, edit."""

from __future__ import annotations

import json
import os
import re
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from kompass_console.cli_error import CliError
from kompass_console.rules_cli.options import (
    Author,
    Probation,
    Reason,
    RobotOptions,
    Yes,
    author_of,
    command,
    probation_seconds,
)

if TYPE_CHECKING:
    from kompass.rules.schema.table import Table
    from kompass_console.rules_cli.table_file import TableFile

EDITOR = "vi"  # where neither VISUAL nor EDITOR says another
RuleIds = Annotated[list[str], typer.Argument(metavar="RULE...", help="Ids of rules.")]


def add_to(app: typer.Typer) -> None:
    """Add the commands."""
    command(app, "set")(set_)
    command(app, "enable")(enable)
    command(app, "disable")(disable)
    command(app, "edit")(edit)


def set_(
    robot: RobotOptions,
    rule: Annotated[str, typer.Argument(help="Id of a rule.")],
    fields: Annotated[
        list[str],
        typer.Argument(
            metavar="FIELD=VALUE...",
            help="Fields as 'check' names them, e.g. event.cooldown=20, shadow=true, "
            "actions[0].text='it is late'.",
        ),
    ],
    reason: Reason = "",
    yes: Yes = False,
    probation: Probation = "default",
    author: Author = None,
) -> None:
    """Change fields of one rule, and apply."""
    _change(robot, [rule], fields, reason, yes, probation, author)


def enable(
    robot: RobotOptions,
    rules: RuleIds,
    reason: Reason = "",
    yes: Yes = False,
    probation: Probation = "default",
    author: Author = None,
) -> None:
    """Let rules take part again, and apply."""
    _change(robot, rules, ["enabled=true"], reason, yes, probation, author)


def disable(
    robot: RobotOptions,
    rules: RuleIds,
    reason: Reason = "",
    yes: Yes = False,
    probation: Probation = "default",
    author: Author = None,
) -> None:
    """Let rules take no part, and apply."""
    _change(robot, rules, ["enabled=false"], reason, yes, probation, author)


def edit(
    robot: RobotOptions,
    reason: Reason = "",
    yes: Yes = False,
    probation: Probation = "default",
    author: Author = None,
) -> None:
    """Open the rules in an editor (VISUAL, EDITOR, else vi), and apply what was saved."""
    from kompass.recipe.export import export
    from kompass_console.rules_cli.hand_in import ChangeRequest, hand_in

    wait, who = probation_seconds(probation), author_of(author)
    with robot.connect() as client:
        view = client.get(client.monitor.table())
        text = export(view.table, "yaml")
        handle, name = tempfile.mkstemp(prefix="rules-", suffix=".yaml", text=True)
        path, head = (
            Path(name),
            f"# {view.robot}, revision {view.revision}: save and leave to apply",
        )
        with os.fdopen(handle, "w", encoding="utf-8") as file:
            file.write(f"{head}\n{text}")
        source = _edited(path)
        if source.table == view.table:
            path.unlink()
            typer.echo("nothing was changed")
            return
        request = ChangeRequest(who, reason, yes, view.revision, wait)
        try:
            hand_in(robot, client, source.table, request, source.locate)
        except CliError as problem:
            raise type(problem)(*_kept(problem, path)) from None
        path.unlink()


def _kept(problem: CliError, path: Path) -> tuple[Any, ...]:
    """Arguments of the same problem that also says where the text is: nothing typed is lost."""
    from kompass_console.rules_cli.robot_refused import RobotRefused

    text = f"{problem}; what you wrote is in {path}"
    if isinstance(problem, RobotRefused):
        return text, problem.body, problem.code
    return problem.code, text


def _edited(path: Path) -> TableFile:
    """Let a person edit a file until it is a table, or they give up."""
    editor = os.environ.get("VISUAL") or os.environ.get("EDITOR") or EDITOR
    from kompass_console.rules_cli.table_file import TableFile

    while True:
        try:
            code = subprocess.run([*shlex.split(editor), str(path)], check=False).returncode
        except OSError as error:
            raise CliError(2, f"{editor}: {error.strerror}; set EDITOR to another") from None
        if code:
            raise CliError(1, f"{editor} ended with {code}; what you wrote is in {path}")
        try:
            return TableFile(path)
        except CliError as problem:
            typer.echo(str(problem), err=True)
            if not sys.stdin.isatty() or not typer.confirm("edit it again?", default=True):
                raise CliError(2, f"nothing was applied; what you wrote is in {path}") from None


def _change(
    robot: RobotOptions,
    rule_ids: list[str],
    fields: list[str],
    reason: str,
    yes: bool,
    probation: str,
    author: str | None,
) -> None:
    from kompass_console.rules_cli.hand_in import ChangeRequest, hand_in

    wait, who = probation_seconds(probation), author_of(author)
    changes = [_assignment(field) for field in fields]
    with robot.connect() as client:
        view = client.get(client.monitor.table())
        table = changed(view.table, rule_ids, changes)
        hand_in(robot, client, table, ChangeRequest(who, reason, yes, view.revision, wait))


def changed(table: Table, rule_ids: list[str], changes: list[tuple[str, Any]]) -> Table:
    """A table with fields of some of its rules changed.

    Raises
    ------
    CliError
        When there is no such rule or field, or the value does not fit.
    """
    from kompass.monitor.tables.table_reader import Unreadable, read_table

    data = json.loads(table.model_dump_json())
    rules = {rule["id"]: rule for rule in data["rules"]}
    for rule_id in rule_ids:
        if rule_id not in rules:
            raise CliError(2, f"there is no rule '{rule_id}'; there are: {', '.join(rules)}")
        for field, value in changes:
            _put(rules[rule_id], field, value)
        rules[rule_id]["source"] = "edited"
    try:
        return read_table(json.dumps(data))
    except Unreadable as error:
        raise CliError(2, str(error)) from None


def _put(rule: Any, field: str, value: Any) -> None:
    steps = [int(step) if step.isdigit() else step for step in re.findall(r"[^.\[\]]+", field)]
    at = rule
    try:
        for step in steps[:-1]:
            at = at[step]
        if isinstance(at, list):
            at[steps[-1]]  # a place that there is not yet is a mistake
        at[steps[-1]] = value
    except (IndexError, KeyError, TypeError):
        raise CliError(
            2, f"rule '{rule['id']}' has no field {field}; 'rules export' shows what it has"
        ) from None


def _assignment(text: str) -> tuple[str, Any]:
    field, equals, value = text.partition("=")
    if not field or not equals:
        raise CliError(2, f"{text!r} is no FIELD=VALUE, e.g. event.cooldown=20")
    import yaml

    try:
        return field, yaml.safe_load(value)
    except yaml.YAMLError as error:
        raise CliError(2, f"{text}: {' '.join(str(error).split())}; put it in quotes") from None
