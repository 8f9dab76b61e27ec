"""The command line: ``kompass-console run | demo | attach | rules | drill | …``."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Annotated

import typer

from kompass.simulation.faults.fault_names import FAULTS
from kompass_console.audit_cli import app as audit
from kompass_console.bench_cli import EXIT_CODES as BENCH_EXIT_CODES
from kompass_console.bench_cli import bench_nav
from kompass_console.cli_error import CliError
from kompass_console.domain import (
    Network,
    RobotKey,
    RosControl,
    choose_domain,
    choose_key,
    choose_ros_control,
)
from kompass_console.drill_cli import app as drill
from kompass_console.drill_cli import recipe_first
from kompass_console.rules_cli.app import app as rules
from kompass_console.users_cli import app as users

# What each command needs is imported when it runs: help answers at once, and Ctrl-C during the
# imports finds somebody who knows what it means.
DEFAULT_WORLD = "hexagon"
# What the monitor and the recorder read; they are not imported here, for they bring ROS.
SAFE_MODE = "KOMPASS_SAFE_MODE"
RECORD = "KOMPASS_RECORD"
EXIT_CODES = """
Exit codes: 0 ended by Ctrl-C or by itself, 1 the stack could not start or run, 2 something in
the command is wrong (a missing file, a port in use), 3 the recipe has an error.
"""

app = typer.Typer(
    name="kompass-console",
    help="Drive and heal a ROS 2 robot from the browser.",
    epilog=EXIT_CODES,
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)

app.add_typer(rules)
app.add_typer(audit)
app.add_typer(drill)
app.add_typer(users)
app.command("bench-nav", epilog=BENCH_EXIT_CODES)(bench_nav)

Host = Annotated[
    str, typer.Option(help="Address to listen on. Others than loopback are seen by the network.")
]
Port = Annotated[int, typer.Option(min=0, max=65535, help="Port to listen on; 0 takes a free one.")]
NoBrowser = Annotated[bool, typer.Option("--no-browser", help="Do not open a browser.")]
DomainId = Annotated[
    int | None, typer.Option(min=0, max=232, help="ROS domain; else ROS_DOMAIN_ID, else 0.")
]
Name = Annotated[str | None, typer.Option(help="What the console calls the robot.")]
Token = Annotated[
    str | None,
    typer.Option(
        help="Access token of the operator, at least 16 characters; else a new one each time.",
        envvar="KOMPASS_CONSOLE_TOKEN",
        show_default=False,
    ),
]
TlsCert = Annotated[
    Path | None,
    typer.Option(help="Certificate (PEM) to serve https with; goes with --tls-key."),
]
TlsKey = Annotated[
    Path | None, typer.Option(help="Private key (PEM) of the certificate; goes with --tls-cert.")
]
TrustedProxy = Annotated[
    list[str] | None,
    typer.Option(
        metavar="ADDRESS",
        help="Address of a reverse proxy whose X-Forwarded-For and -Proto are believed; may be "
        "given several times. Nobody's are, if it is left out.",
        show_default=False,
    ),
]
IdleLimit = Annotated[
    float,
    typer.Option(
        min=0.01,
        max=168,
        help="Hours after which somebody has to log in again who had no page open.",
    ),
]
NoOpenStop = Annotated[
    bool,
    typer.Option(
        "--no-stop-without-login",
        help="No STOP on the log-in page, which whoever reaches the console may press.",
    ),
]
Webhooks = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE",
        help="Addresses that are told when the robot is stopped, fails or needs somebody (YAML). "
        "Nobody is told of anything, if it is left out.",
        envvar="KOMPASS_WEBHOOKS",
        show_default=False,
    ),
]
Sim = Annotated[
    str | None,
    typer.Option(
        "--sim",
        metavar="[WORLD]",
        help=f"Bring the embedded robot too, in a world of its own ({DEFAULT_WORLD} if not named).",
    ),
]
Fault = Annotated[
    list[str] | None,
    typer.Option(
        metavar="NAME[:SECONDS[:DURATION]]",
        help="Switch a fault of the embedded robot on, so many seconds after the start, and off "
        "again after the duration; may be given several times. Known: " + ", ".join(FAULTS) + ".",
    ),
]

Robot = Annotated[
    str | None,
    typer.Option(
        metavar="NAME",
        help="Which embedded robot: turtlebot3, jackal, turtlebot3-plus, ackermann or omni. Left "
        "out, it is one that moves as the recipe describes, with the sensors that it listens to.",
    ),
]

DataDir = Annotated[
    Path | None,
    typer.Option(
        help="Where robots keep their rules and recordings; else KOMPASS_DATA_DIR, else 'kompass' "
        "in the XDG state folder.",
        show_default=False,
    ),
]
SafeMode = Annotated[
    bool,
    typer.Option(
        "--safe-mode", help="Begin with the recipe's rules; edits are kept for the next start."
    ),
]
NoRecord = Annotated[bool, typer.Option("--no-record", help="Start without the flight recorder.")]
SingleProcess = Annotated[
    bool,
    typer.Option(
        "--single-process",
        help="All components in one process, whatever the recipe says (KOMPASS_MULTI_PROCESSING).",
    ),
]


@app.command()
def run(
    recipe: Annotated[Path, typer.Argument(help="A Python file that calls launcher.bringup().")],
    sim: Sim = None,
    robot: Robot = None,
    fault: Fault = None,
    host: Host = "127.0.0.1",
    port: Port = 8642,
    no_browser: NoBrowser = False,
    domain_id: DomainId = None,
    network: Network = None,
    ros_control: RosControl = None,
    robot_key: RobotKey = None,
    name: Name = None,
    token: Token = None,
    tls_cert: TlsCert = None,
    tls_key: TlsKey = None,
    trusted_proxy: TrustedProxy = None,
    idle_limit: IdleLimit = 12.0,
    no_stop_without_login: NoOpenStop = False,
    webhooks: Webhooks = None,
    data_dir: DataDir = None,
    safe_mode: SafeMode = False,
    no_record: NoRecord = False,
    single_process: SingleProcess = False,
) -> None:
    """Run a recipe, and the console beside it."""
    if not recipe.is_file():
        raise CliError(2, f"there is no recipe {recipe}; give the path of a Python file")
    ros = choose_domain(domain_id, network)
    ros += choose_ros_control(ros_control)
    choose_key(robot_key)
    if single_process:
        os.environ["KOMPASS_MULTI_PROCESSING"] = "0"
    from kompass_console.stack import ConsoleListener, Door, run_recipe

    called = _prepare(name, sim, data_dir, safe_mode=safe_mode, no_record=no_record)
    door = Door(tls_cert, tls_key, trusted_proxy or [], idle_limit, not no_stop_without_login)
    console = ConsoleListener(host, port, not no_browser, called, token, ros, door, webhooks)
    run_recipe(recipe, console, sim, fault or [], robot)


@app.command()
def demo(
    world: Annotated[str, typer.Option(help="World of the embedded robot.")] = DEFAULT_WORLD,
    fault: Fault = None,
    host: Host = "127.0.0.1",
    port: Port = 8642,
    no_browser: NoBrowser = False,
    domain_id: DomainId = None,
    network: Network = None,
    ros_control: RosControl = None,
    robot_key: RobotKey = None,
    name: Name = None,
    token: Token = None,
    tls_cert: TlsCert = None,
    tls_key: TlsKey = None,
    trusted_proxy: TrustedProxy = None,
    idle_limit: IdleLimit = 12.0,
    no_stop_without_login: NoOpenStop = False,
    webhooks: Webhooks = None,
    data_dir: DataDir = None,
    safe_mode: SafeMode = False,
    no_record: NoRecord = False,
) -> None:
    """Try it: an embedded robot, the navigation stack and the console."""
    ros = choose_domain(domain_id, network)
    ros += choose_ros_control(ros_control)
    choose_key(robot_key)
    from kompass.share import recipe_path
    from kompass_console.stack import ConsoleListener, Door, run_recipe

    robot = _prepare(name, world, data_dir, safe_mode=safe_mode, no_record=no_record)
    door = Door(tls_cert, tls_key, trusted_proxy or [], idle_limit, not no_stop_without_login)
    console = ConsoleListener(host, port, not no_browser, robot, token, ros, door, webhooks)
    run_recipe(recipe_path("01_point_navigation.py"), console, world, fault or [])


@app.command()
def attach(
    host: Host = "127.0.0.1",
    port: Port = 8642,
    no_browser: NoBrowser = False,
    domain_id: DomainId = None,
    network: Network = None,
    robot_key: RobotKey = None,
    name: Name = None,
    token: Token = None,
    tls_cert: TlsCert = None,
    tls_key: TlsKey = None,
    trusted_proxy: TrustedProxy = None,
    idle_limit: IdleLimit = 12.0,
    no_stop_without_login: NoOpenStop = False,
    webhooks: Webhooks = None,
) -> None:
    """Show a stack that something else started, on this machine or another of the ROS domain."""
    ros = choose_domain(domain_id, network)
    choose_key(robot_key)
    from kompass_console.stack import ConsoleListener, Door, run_attached

    door = Door(tls_cert, tls_key, trusted_proxy or [], idle_limit, not no_stop_without_login)
    robot = name or _robot_name(None)
    run_attached(ConsoleListener(host, port, not no_browser, robot, token, ros, door, webhooks))


def _prepare(
    name: str | None,
    world: str | None,
    data_dir: Path | None,
    *,
    safe_mode: bool,
    no_record: bool,
) -> str:
    """Tell the stack what the command says, through the environment; the robot's name."""
    from kompass.store.paths import DATA_DIR, ROBOT_NAME

    robot = name or os.environ.get(ROBOT_NAME) or _robot_name(world)
    os.environ[ROBOT_NAME] = robot
    if data_dir is not None:
        if data_dir.exists() and not data_dir.is_dir():
            raise CliError(2, f"--data-dir {data_dir} is a file; give a folder")
        os.environ[DATA_DIR] = str(data_dir.absolute())
    if safe_mode:
        os.environ[SAFE_MODE] = "1"
    if no_record:
        os.environ[RECORD] = "0"
    return robot


def _robot_name(world: str | None) -> str:
    return f"tb3-{world}" if world else os.uname().nodename


def name_the_world(arguments: list[str]) -> list[str]:
    """``--sim`` may stand alone; give it its world, since options take a value or none."""
    if "--sim" not in arguments:
        return arguments
    from kompass.simulation.worlds.registry import world_names

    known = world_names()
    given = list(arguments)
    for index, argument in enumerate(given):
        if argument == "--sim":
            following = given[index + 1] if index + 1 < len(given) else "-"
            is_world = following in known or (
                not following.startswith("-") and not following.endswith(".py")
            )
            if not is_world:
                given[index] = f"--sim={DEFAULT_WORLD}"
    return given


def main() -> None:
    """Run the command that was typed."""
    try:
        app(name_the_world(recipe_first(sys.argv[1:])), standalone_mode=True)
    except CliError as problem:
        typer.echo(f"kompass-console: {problem}", err=True)
        raise SystemExit(problem.code) from None
