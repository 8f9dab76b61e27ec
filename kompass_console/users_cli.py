"""``kompass-console users``: who may log in to this robot's console by name."""

from __future__ import annotations

import contextlib
import os
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from kompass_console.cli_error import CliError
from kompass_console.schema.roles import Role

if TYPE_CHECKING:
    from kompass_console.accounts.accounts import Accounts

EXIT_CODES = """
Exit codes: 0 done, 1 it could not be done, 2 something in the command is wrong.
"""

app = typer.Typer(
    name="users",
    help="Who may log in to this robot's console by name. A console that runs knows at once.",
    epilog=EXIT_CODES,
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
)

Name = Annotated[str, typer.Argument(help="Of the person, as all others will see it.")]
DataDir = Annotated[
    Path | None,
    typer.Option(help="Where robots keep their data; else as for 'run'.", show_default=False),
]
Stdin = Annotated[
    bool, typer.Option("--stdin", help="Take the password from standard input, its first line.")
]
ROLES = "viewer watches and may stop, operator drives, engineer edits the rules, too."


@app.command()
def add(
    name: Name,
    role: Annotated[Role, typer.Option(help=ROLES)],
    stdin: Stdin = False,
    data_dir: DataDir = None,
) -> None:
    """Let somebody in."""
    with _told():
        accounts = _accounts(data_dir)
        if (taken := accounts.find(name)) is not None:
            raise CliError(1, f"there is an account {taken.name} already")
        first = not accounts.all()
        account = accounts.add(name, role, _password(stdin))
    typer.echo(f"{account.name} may log in as {account.role}.")
    if first:
        typer.echo(
            "From its next start on, the console prints no tokens any more: people log in by name."
        )


@app.command()
def passwd(name: Name, stdin: Stdin = False, data_dir: DataDir = None) -> None:
    """Give somebody a new password; who is logged in with the old one is logged out."""
    with _told():
        accounts = _accounts(data_dir)
        _there(accounts, name)
        account = accounts.set_password(name, _password(stdin))
    typer.echo(f"{account.name} has a new password; all sessions of {account.name} have ended.")


@app.command()
def role(
    name: Name, role: Annotated[Role, typer.Argument(help=ROLES)], data_dir: DataDir = None
) -> None:
    """Let somebody do more, or less; who is logged in is logged out."""
    with _told():
        account = _accounts(data_dir).set_role(name, role)
    typer.echo(f"{account.name} is {account.role} now; all sessions of {account.name} have ended.")


@app.command()
def logout(name: Name, data_dir: DataDir = None) -> None:
    """Log somebody out everywhere, after a tablet is lost for example."""
    with _told():
        _accounts(data_dir).end_sessions(name)
    typer.echo(f"All sessions of {name} have ended.")


@app.command()
def remove(name: Name, data_dir: DataDir = None) -> None:
    """Let somebody in no more, from now on."""
    with _told():
        accounts = _accounts(data_dir)
        account = accounts.remove(name)
        left = accounts.all()
    typer.echo(f"{account.name} cannot log in any more; all sessions of {account.name} have ended.")
    if not left:
        typer.echo("That was the last account: from its next start on, the console prints tokens.")


@app.command(name="list")
def show(data_dir: DataDir = None) -> None:
    """Who may log in, and as what."""
    with _told():
        accounts = _accounts(data_dir).all()
    for account in accounts:
        since = time.strftime("%Y-%m-%d", time.localtime(account.created))
        typer.echo(f"{account.role:<8}  since {since}  {account.name}")
    if not accounts:
        typer.echo("There are no accounts: who has a token that the console prints logs in by it.")


@contextlib.contextmanager
def _told() -> Iterator[None]:
    """What cannot be done is told in a sentence."""
    from kompass_console.accounts.accounts import AccountRefused, AccountsUnreadable

    try:
        yield
    except (AccountRefused, AccountsUnreadable) as error:
        raise CliError(1, str(error)) from None


def _accounts(folder: Path | None) -> Accounts:
    from kompass.store.errors import StoreUnwritable
    from kompass.store.paths import DATA_DIR, data_dir
    from kompass_console.accounts.accounts import FILE, Accounts

    environment = dict(os.environ)
    if folder is not None:
        environment[DATA_DIR] = str(folder.absolute())
    try:
        return Accounts(data_dir(environment) / FILE)
    except StoreUnwritable as error:
        raise CliError(2, str(error)) from None


def _there(accounts: Accounts, name: str) -> None:
    """Say that nobody is called so before a password is asked for."""
    if accounts.find(name) is None:
        known = ", ".join(account.name for account in accounts.all()) or "none"
        raise CliError(1, f"there is no account {name!r}; there are: {known}")


def _password(stdin: bool) -> str:
    """Its hash; asked for twice, and shown nowhere."""
    from kompass_console.accounts.passwords import hashed

    if stdin:
        given = sys.stdin.readline().rstrip("\n")
    elif sys.stdin.isatty():
        given = typer.prompt("Password", hide_input=True, confirmation_prompt="Again")
    else:
        raise CliError(2, "there is no terminal to ask for the password; give --stdin")
    try:
        return hashed(given)
    except ValueError as error:
        raise CliError(2, str(error)) from None
