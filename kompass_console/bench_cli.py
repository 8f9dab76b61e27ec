"""``kompass-console bench-nav``: how well the stack finds its way through worlds of a benchmark."""

from __future__ import annotations

import os
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, get_args

import typer

from kompass_console.cli_error import CliError
from kompass_console.driving import (
    BAD_INPUT,
    INTERRUPTED,
    NOT_DRIVEN,
    check_writable,
    ended_as_by_hand,
    with_progress,
    write_all,
)

if TYPE_CHECKING:
    from kompass.bench.barn_file import BarnFile, BarnWorld
    from kompass.bench.drive import BenchDrive

EXIT_CODES = """
Exit codes: 0 all drives were made, whatever became of them, 2 something in the command is wrong,
3 a drive could not be made, 130 ended by hand (Ctrl-C, SIGTERM). With 3 and 130 the files have the
drives that were made until then.
"""


def bench_nav(
    worlds: Annotated[Path, typer.Option(help="File of BARN worlds (JSON).")],
    only: Annotated[
        str, typer.Option(help="Their indices, separated by commas; all when left out.")
    ] = "",
    robot: Annotated[str, typer.Option(help="Embedded robot.")] = "turtlebot3",
    follower: Annotated[
        str | None,
        typer.Option(help="Algorithm of the controller; its default when left out."),
    ] = None,
    map_: Annotated[
        str,
        typer.Option(
            "--map",
            help="What the stack is told beforehand: 'known' for all, 'walls' for the floor and "
            "its outer wall, 'none' for nothing.",
        ),
    ] = "none",
    seed: Annotated[int, typer.Option(min=0, help="The first seed.")] = 0,
    seeds: Annotated[int, typer.Option(min=1, max=1000, help="Drives through each world.")] = 1,
    jobs: Annotated[
        int | None, typer.Option(min=1, max=256, help="Drives at a time; else one per processor.")
    ] = None,
    real: Annotated[
        bool,
        typer.Option(
            "--real", help="Processes of its own, over DDS, in real time; one drive at a time."
        ),
    ] = False,
    json_file: Annotated[
        Path | None, typer.Option("--json", help="Write a line of JSON per drive to this file.")
    ] = None,
    report_file: Annotated[
        Path | None, typer.Option("--report", help="Write a page to look at (HTML) to this file.")
    ] = None,
) -> None:
    """Drive through worlds of BARN, and say what became of it by BARN's metric."""
    from kompass.bench.drive import MapKnown, means
    from kompass.bench.real import make_real_drives
    from kompass.bench.report import report_html
    from kompass.bench.runner import BenchOrder, make_bench_drives
    from kompass.bench.score import THERE
    from kompass.bench.stack import LIMITS
    from kompass.components.controller.config import ControllerConfig
    from kompass.components.controller.controllers_id import FOLLOWERS_OF_PATHS, ControllersID
    from kompass.drills.runner.worker import DriveFailed

    file = _read(worlds)
    chosen = _chosen(file, worlds, only)
    for one in chosen:
        try:
            one.place(file.start, file.goal)
        except ValueError as error:
            raise CliError(BAD_INPUT, f"--worlds: {worlds}: {error}") from None
    known = {one.value.lower(): one.value for one in FOLLOWERS_OF_PATHS}
    known |= {one.name.lower(): one.value for one in FOLLOWERS_OF_PATHS}
    default = str(ControllerConfig().algorithm.value)
    _check("--robot", robot, tuple(LIMITS))
    _check("--map", map_, get_args(MapKnown))
    if follower is not None and follower.lower() not in known:
        names = [one.value for one in FOLLOWERS_OF_PATHS]
        if any(follower.lower() in (one.value.lower(), one.name.lower()) for one in ControllersID):
            raise CliError(
                BAD_INPUT,
                f"--follower {follower}: it follows a target in a camera's image, and no path; "
                f"choose one of {', '.join(names)}",
            )
        _check("--follower", follower, names)
    for option, each in (("--json", json_file), ("--report", report_file)):
        if each is not None:
            check_writable(option, each)
    orders = [
        BenchOrder(
            world=world,
            start=file.start,
            goal=file.goal,
            robot=robot,
            follower=default if follower is None else known[follower.lower()],
            map=map_,  # type: ignore[arg-type]  # checked above
            seed=number,
        )
        for world in chosen
        for number in range(seed, seed + seeds)
    ]
    if real and jobs not in (None, 1):
        raise CliError(
            BAD_INPUT, f"--jobs {jobs}: with --real there is one drive at a time; leave it out"
        )
    made: dict[int, BenchDrive] = {}
    ended: CliError | None = None
    try:
        if real:
            drives = make_real_drives(orders)
        else:
            drives = make_bench_drives(orders, jobs or os.cpu_count() or 1)
        # Those that wait are not driven when this is left.
        with ended_as_by_hand(), closing(drives):
            for index, drive in with_progress(drives, len(orders)):
                made[index] = drive
                typer.echo(drive.model_dump_json(exclude={"track"}))
    except DriveFailed as error:
        ended = CliError(NOT_DRIVEN, str(error))
    except KeyboardInterrupt:
        ended = CliError(INTERRUPTED, f"ended by hand after {len(made)} of {len(orders)} drives")
    # What was driven until then may have taken hours: it is not lost with what was not.
    in_order = [made[index] for index in sorted(made)]
    if in_order:
        found = means(in_order, THERE)
        lines = [each.model_dump_json() for each in (*in_order, found)]
        shown = {world.name: world for world in chosen}
        unwritten = write_all(
            ("--json", json_file, lambda: "\n".join(lines) + "\n"),
            ("--report", report_file, lambda: report_html(in_order, shown, file)),
        )
        typer.echo(found.sentence)
        ended = ended or unwritten
    if ended is not None:
        raise ended


def _read(worlds: Path) -> BarnFile:
    from kompass.bench.barn_file import BadWorlds, read_barn

    try:
        return read_barn(worlds)
    except BadWorlds as error:
        raise CliError(BAD_INPUT, f"--worlds: {error}") from None


def _chosen(file: BarnFile, worlds: Path, only: str) -> tuple[BarnWorld, ...]:
    parts = [part.strip() for part in only.split(",") if part.strip()]
    for part in parts:
        if not part.isdecimal():
            raise CliError(
                BAD_INPUT, f"--only {part}: that is no index; give numbers with commas, as 0,6,12"
            )
    try:
        return file.chosen([int(part) for part in parts])
    except KeyError as error:
        indices = [world.index for world in file.worlds]
        raise CliError(
            BAD_INPUT,
            f"--only {error.args[0]}: {worlds} has no such world; it has {len(indices)}, "
            f"from {min(indices)} to {max(indices)}",
        ) from None


def _check(option: str, value: str, known: object) -> None:
    names = list(known)  # type: ignore[call-overload]
    if value not in names:
        raise CliError(
            BAD_INPUT, f"{option} {value}: there is no such thing; choose one of {', '.join(names)}"
        )
