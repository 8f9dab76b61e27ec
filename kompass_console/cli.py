"""The command line: ``kompass-console run | demo | attach``."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Annotated

import typer

from kompass.simulation.faults import FAULTS
from kompass_console.problem import Problem

# What each command needs is imported when it runs: help answers at once, and Ctrl-C during the
# imports finds somebody who knows what it means.
DEFAULT_WORLD = "hexagon"
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
        metavar="NAME[:SECONDS]",
        help="Switch a fault of the embedded robot on, so many seconds after the start; may be "
        "given several times. Known: " + ", ".join(FAULTS) + ".",
    ),
]


@app.command()
def run(
    recipe: Annotated[Path, typer.Argument(help="A Python file that calls launcher.bringup().")],
    sim: Sim = None,
    fault: Fault = None,
    host: Host = "127.0.0.1",
    port: Port = 8642,
    no_browser: NoBrowser = False,
    domain_id: DomainId = None,
    name: Name = None,
    token: Token = None,
) -> None:
    """Run a recipe, and the console beside it."""
    if not recipe.is_file():
        raise Problem(2, f"there is no recipe {recipe}; give the path of a Python file")
    _choose_domain(domain_id, alone=sim is not None)
    from kompass_console.stack import Console, run_recipe

    console = Console(host, port, not no_browser, name or _robot_name(sim), token)
    run_recipe(recipe, console, sim, fault or [])


@app.command()
def demo(
    world: Annotated[str, typer.Option(help="World of the embedded robot.")] = DEFAULT_WORLD,
    fault: Fault = None,
    host: Host = "127.0.0.1",
    port: Port = 8642,
    no_browser: NoBrowser = False,
    domain_id: DomainId = None,
    name: Name = None,
    token: Token = None,
) -> None:
    """Try it: an embedded robot, the navigation stack and the console."""
    _choose_domain(domain_id, alone=True)
    from kompass.share import recipe_path
    from kompass_console.stack import Console, run_recipe

    console = Console(host, port, not no_browser, name or _robot_name(world), token)
    run_recipe(recipe_path("01_point_navigation.py"), console, world, fault or [])


@app.command()
def attach(
    host: Host = "127.0.0.1",
    port: Port = 8642,
    no_browser: NoBrowser = False,
    domain_id: DomainId = None,
    name: Name = None,
    token: Token = None,
) -> None:
    """Show a stack that something else started, on this machine or another of the ROS domain."""
    _choose_domain(domain_id, alone=False)
    from kompass_console.stack import Console, run_attached

    run_attached(Console(host, port, not no_browser, name or _robot_name(None), token))


def _choose_domain(domain_id: int | None, *, alone: bool) -> None:
    """Set what rclpy reads from the environment; a robot of our own stays on this machine.

    Comes before rclpy is imported: with a middleware it does not find it ends the process.
    """
    from kompass.launch.environment import EnvironmentProblem, check_environment
    from kompass.middleware import RANGE, prepare_middleware

    if domain_id is not None:
        os.environ["ROS_DOMAIN_ID"] = str(domain_id)
    if alone:
        os.environ.setdefault(RANGE, "LOCALHOST")
        prepare_middleware()
    try:
        check_environment()
    except EnvironmentProblem as error:
        raise Problem(1, str(error)) from None


def _robot_name(world: str | None) -> str:
    return f"tb3-{world}" if world else os.uname().nodename


def name_the_world(arguments: list[str]) -> list[str]:
    """``--sim`` may stand alone; give it its world, since options take a value or none."""
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
    """Entry point of ``kompass-console``."""
    try:
        app(name_the_world(sys.argv[1:]), standalone_mode=True)
    except Problem as problem:
        typer.echo(f"kompass-console: {problem}", err=True)
        raise SystemExit(problem.code) from None
    except KeyboardInterrupt:
        raise SystemExit(130) from None
