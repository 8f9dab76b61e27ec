"""What all commands have: which robot, who asks, and how to print."""

from __future__ import annotations

import getpass
import inspect
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer

from kompass_console.cli_error import CliError
from kompass_console.domain import Network, RobotKey, choose_domain, choose_key

# Models and ROS are imported when a command runs: help answers at once.
if TYPE_CHECKING:
    from kompass.rules.schema.model import Model
    from kompass_console.rules_cli.connection import MonitorConnection
    from kompass_console.rules_cli.looking import Looking

ROLE = "engineer"  # whoever has the robot's key is one
DomainId = Annotated[
    int | None, typer.Option(min=0, max=232, help="ROS domain; else ROS_DOMAIN_ID, else 0.")
]
Namespace = Annotated[
    str | None, typer.Option(help="Of the robot; needed only where there are several.")
]
Timeout = Annotated[float, typer.Option(min=0.1, help="Seconds that the robot may take.")]
Json = Annotated[bool, typer.Option("--json", help="Print the robot's answer as JSON.")]
Author = Annotated[
    str | None, typer.Option(help="Who does it, for the history; else the login name.")
]

Reason = Annotated[str, typer.Option("--reason", "-m", help="Why, for the history.")]
Yes = Annotated[bool, typer.Option("--yes", "-y", help="Do not ask.")]
Probation = Annotated[
    str,
    typer.Option(
        metavar="SECONDS|off",
        help="It is taken back after so many seconds unless confirmed; else the robot's default.",
        show_default=False,
    ),
]


class RobotOptions(NamedTuple):
    """The robot that a command is for, and how to print what it says."""

    domain_id: int | None
    network: str | None
    robot_key: Path | None
    namespace: str | None
    timeout: float
    json: bool

    def connect(self) -> MonitorConnection:
        """Find its monitor.

        Raises
        ------
        CliError
            When there is none.
        """
        choose_domain(self.domain_id, self.network)
        choose_key(self.robot_key)
        from kompass_console.rules_cli.connection import MonitorConnection

        return MonitorConnection(self.namespace, self.timeout)

    @contextmanager
    def look(self) -> Iterator[Looking]:
        """Find its monitor, to ask what changes nothing: on this machine without ROS.

        Raises
        ------
        CliError
            When there is none.
        """
        from kompass_console.rules_cli.looking import LookingHere, LookingOverRos, monitor_here

        choose_domain(self.domain_id, self.network)
        choose_key(self.robot_key)
        here = monitor_here(self.namespace)
        if here is not None:
            yield LookingHere(here, self.timeout)
            return
        with self.connect() as connection:
            yield LookingOverRos(connection)

    def tell(self, answer: Model, show: Callable[[], None]) -> None:
        """Print an answer as JSON, or as ``show`` does."""
        if self.json:
            typer.echo(answer.model_dump_json(indent=2))
        else:
            show()


def command(app: typer.Typer, name: str) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Add a command whose first parameter is the :class:`RobotOptions`, from options of its own."""

    def add(function: Callable[..., None]) -> Callable[..., None]:
        signature = inspect.signature(function, eval_str=True)
        own = [p for p in signature.parameters.values() if p.annotation is not RobotOptions]

        def run(**given: Any) -> None:
            robot = RobotOptions(*(given.pop(field) for field in RobotOptions._fields))
            function(robot, **given)

        run.__signature__ = inspect.Signature([*own, *_COMMON])  # type: ignore[attr-defined]
        run.__doc__ = function.__doc__
        app.command(name)(run)
        return function

    return add


def _option(name: str, annotation: Any, default: Any) -> inspect.Parameter:
    keyword = inspect.Parameter.KEYWORD_ONLY
    return inspect.Parameter(name, keyword, default=default, annotation=annotation)


_COMMON = (
    _option("domain_id", DomainId, None),
    _option("network", Network, None),
    _option("robot_key", RobotKey, None),
    _option("namespace", Namespace, None),
    _option("timeout", Timeout, 10.0),
    _option("json", Json, False),
)


def author_of(given: str | None) -> str:
    """Who asks.

    Raises
    ------
    CliError
        When nobody knows.
    """
    if given:
        return given
    try:
        return getpass.getuser()
    except (KeyError, OSError):
        raise CliError(2, "nobody knows your login name here; give --author") from None


def probation_seconds(text: str) -> float:
    """What ``--probation`` says, in seconds: 0 for none, -1 for the robot's default.

    Raises
    ------
    CliError
        When it is neither seconds nor ``off``.
    """
    if text == "default":
        return -1.0
    if text == "off":
        return 0.0
    try:
        seconds = float(text.removesuffix("s"))
    except ValueError:
        seconds = -1.0
    if not 0.0 < seconds <= 86_400.0:
        raise CliError(2, f"--probation {text}: give seconds (at most a day), or 'off'")
    return seconds
