"""``kompass-console drill``: what a change of the rules would do to the robot, beforehand."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Sequence
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

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
    from kompass.drills.draw import DrawOptions
    from kompass.drills.drive import DriveResult
    from kompass.drills.report_json import Report, TableName
    from kompass.drills.runner.worker import Looked
    from kompass.drills.scenario import Scenario
    from kompass.rules.schema.table import Table

FAILED, NOT_REPEATABLE = 1, 4
NOT_LOOKED_TWICE = (
    "whether the recipe is the same twice was not found out: the first drive was not made again"
)
NONE_MADE = "ended by hand before a drive was made"
DRIVES = 20  # that are drawn where nobody says how many
EXIT_CODES = """
Exit codes: 0 the drill was made and all that --require asks for is met, 1 something of that is
not met, 2 something in the command is wrong, 3 a drive could not be made, 4 the recipe is not the
same twice: results are shown, and may be chance, 130 ended by hand (Ctrl-C, or SIGTERM). With 3
and 130 the results are those of the drives that were made until then.
"""

app = typer.Typer(
    name="drill",
    help="Try a recipe and its rules in many faulted drives, in virtual time.\n\n"
    "drill RECIPE is drill run RECIPE: its options are told by drill run --help.",
    epilog=EXIT_CODES,
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
)


@app.command("run", epilog=EXIT_CODES)
def run(
    context: typer.Context,
    recipe: Annotated[Path, typer.Argument(help="A Python file that calls launcher.bringup().")],
    rules: Annotated[
        Path | None,
        typer.Option(help="Table of rules to try (JSON or YAML); 'recipe', or left out: its own."),
    ] = None,
    against: Annotated[
        Path | None,
        typer.Option(help="Another table to compare it with; 'recipe' for the recipe's own."),
    ] = None,
    worlds: Annotated[
        str,
        typer.Option(
            help="Worlds of the embedded robot, separated by commas; left out, the hexagon, or "
            "the first one that has room for the robot."
        ),
    ] = "",
    robot: Annotated[
        str,
        typer.Option(help="Which embedded robot; left out, one like that of the recipe."),
    ] = "",
    faults: Annotated[
        str, typer.Option(help="Faults, separated by commas; 'all', or empty for none.")
    ] = "all",
    faults_per_drive: Annotated[
        int, typer.Option(min=1, max=10, help="How many of them strike in each drive.")
    ] = 1,
    lasting: Annotated[
        float, typer.Option(min=0.0, max=1.0, help="Share of the faults that never end.")
    ] = 0.0,
    seed: Annotated[int, typer.Option(min=0, help="What all chance comes from.")] = 1,
    seeds: Annotated[
        int | None,
        typer.Option(
            min=1, max=100_000, help="How many drives: 20, or with --scenarios 1 of each."
        ),
    ] = None,
    scenarios: Annotated[
        Path | None,
        typer.Option(help="A file or folder of scenarios (YAML) instead of drawn ones."),
    ] = None,
    jobs: Annotated[
        int | None, typer.Option(min=1, max=256, help="Drives at a time; else one per processor.")
    ] = None,
    json_file: Annotated[
        Path | None, typer.Option("--json", help="Write all of it to this file.")
    ] = None,
    report_file: Annotated[
        Path | None, typer.Option("--report", help="Write a page to look at (HTML) to this file.")
    ] = None,
    require: Annotated[
        str | None, typer.Option(help="What must hold, as 'recovered >= 0.95, contacts == 0'.")
    ] = None,
) -> None:
    """Make drives, and say what became of the robot."""
    from kompass.drills.draw import USUAL_WORLDS
    from kompass.drills.report_html import report_html
    from kompass.drills.report_json import make_report, report_json
    from kompass.drills.requirement import BadRequirement, parse_requirements, refuse_impossible
    from kompass.drills.runner.worker import DriveFailed, look_at
    from kompass.rules.schema.table import Table

    if not recipe.is_file():
        raise CliError(BAD_INPUT, f"there is no recipe {recipe}; give the path of a Python file")
    try:
        requirements = () if require is None else parse_requirements(require)
    except BadRequirement as error:
        raise CliError(BAD_INPUT, f"--require: {error}") from None
    for option, file in (("--json", json_file), ("--report", report_file)):
        if file is not None:
            check_writable(option, file)
    if json_file and report_file and json_file.resolve() == report_file.resolve():
        raise CliError(
            BAD_INPUT, f"--report {report_file}: --json goes to the same file; give another"
        )
    if scenarios is not None:
        _refuse_what_is_drawn(context, "worlds", "robot", "faults", "faults_per_drive", "lasting")
    proposed = _table("--rules", rules)
    other = _table("--against", against)
    try:
        with ended_as_by_hand():
            looked = look_at(recipe, proposed)
            chosen, options = _scenarios(
                looked, scenarios, worlds, robot, faults, faults_per_drive, lasting, seed, seeds
            )
            refuse_impossible(requirements, len(chosen))
            if other is not None:
                look_at(recipe, other)
        own = Table.model_validate_json(looked.table)
        tried = (_name(rules, proposed or own), proposed)
        compared = None if against is None else (_name(against, other or own), other)
    except KeyboardInterrupt:
        raise CliError(INTERRUPTED, NONE_MADE) from None
    except BadRequirement as error:
        raise CliError(BAD_INPUT, f"--require: {error}") from None
    except DriveFailed as error:
        raise CliError(NOT_DRIVEN, str(error)) from None
    looked_twice: list[str] = []
    drives, drives_against, ended = _make(
        *(recipe, chosen, tried, compared, jobs or os.cpu_count() or 1), looked_twice.append
    )
    if ended is not None and not drives:
        raise ended
    differences = [said for said in looked_twice if said]
    notes = [*looked.unlike(scenario.robot for scenario in chosen), *differences]
    if options is not None and not worlds and options.worlds[0] != USUAL_WORLDS[0]:
        notes.append(
            f"The {USUAL_WORLDS[0]} has no room for {options.robot}: these drives are in the "
            f"{options.worlds[0]}."
        )
    if ended is not None:
        notes.append(str(ended))
        if not looked_twice:
            notes.append(NOT_LOOKED_TWICE)
    report = make_report(
        recipe=recipe.name,
        table=tried[0],
        drives=drives,
        against=None if compared is None else compared[0],
        drives_against=drives_against,
        seed=None if options is None and (seeds or 1) == 1 else seed,
        options=options,
        requirements=requirements,
        notes=notes,
        names={
            rule.id: rule.name for table in (other or own, proposed or own) for rule in table.rules
        },
    )
    unwritten = write_all(
        ("--json", json_file, lambda: report_json(report)),
        ("--report", report_file, lambda: report_html(report)),
    )
    _tell(report)
    if (problem := ended or unwritten) is not None:
        raise problem
    if differences:
        raise SystemExit(NOT_REPEATABLE)
    met = all(requirement.met for requirement in report.requirements)
    raise SystemExit(0 if met else FAILED)


@app.command("replay", epilog=EXIT_CODES)
def replay(
    drive: Annotated[
        str, typer.Argument(help="Which: its name, as a report has it, or its number in the seed.")
    ],
    recipe: Annotated[Path, typer.Option(help="The recipe that was drilled.")],
    output: Annotated[Path, typer.Option("--output", "-o", help="An MCAP file to be made.")],
    rules: Annotated[
        Path | None, typer.Option(help="Table that was tried; 'recipe', or left out: its own.")
    ] = None,
    scenarios: Annotated[
        Path | None,
        typer.Option("--scenario", "--scenarios", help="File or folder that it was read from."),
    ] = None,
    worlds: Annotated[str, typer.Option(help="As the drill had it.")] = "",
    robot: Annotated[str, typer.Option(help="As the drill had it.")] = "",
    faults: Annotated[str, typer.Option(help="As the drill had it.")] = "all",
    faults_per_drive: Annotated[int, typer.Option(min=1, max=10, help="As the drill had it.")] = 1,
    lasting: Annotated[float, typer.Option(min=0.0, max=1.0, help="As the drill had it.")] = 0.0,
    seed: Annotated[int, typer.Option(min=0, help="As the drill had it.")] = 1,
) -> None:
    """Make one drive again, and write it as the flight recorder writes a robot's."""
    from kompass.drills.drive import DriveResult
    from kompass.drills.runner.worker import DriveFailed, Order, look_at, make_drives

    if not recipe.is_file():
        raise CliError(BAD_INPUT, f"--recipe {recipe}: there is no such file; give a Python file")
    _check_new("-o", output)
    proposed = _table("--rules", rules)
    said: list[str] = []
    made = output.with_name(f".{output.name}.{os.getpid()}.partial")
    try:
        with ended_as_by_hand():
            looked = look_at(recipe, proposed)
            scenario = _scenario(
                looked, drive, scenarios, worlds, robot, faults, faults_per_drive, lasting, seed
            )
            order = Order(recipe, scenario, proposed, made.absolute())
            (((_, text)),) = make_drives([order], os.cpu_count() or 1, said.append)
        said = [difference for difference in said if difference]
        made.rename(output)
    except KeyboardInterrupt:
        raise CliError(INTERRUPTED, NONE_MADE) from None
    except DriveFailed as error:
        raise CliError(NOT_DRIVEN, str(error)) from None
    finally:
        made.unlink(missing_ok=True)
    for note in said:
        typer.echo(f"! {note}")
    result = DriveResult.model_validate_json(text)
    typer.echo(f"{scenario.name}: {result.why}")
    typer.echo(f"{output}: {result.duration:.0f} s of driving, {output.stat().st_size >> 10} KiB")
    raise SystemExit(NOT_REPEATABLE if said else 0)


@app.command("scenario", epilog=EXIT_CODES)
def scenario(
    recording: Annotated[Path, typer.Argument(help="An MCAP file of the flight recorder.")],
    output: Annotated[Path, typer.Option("--output", "-o", help="A YAML file to be made.")],
    begin: Annotated[
        float | None, typer.Option("--from", min=0.0, help="First second of it; else all of it.")
    ] = None,
    end: Annotated[float | None, typer.Option("--to", min=0.0, help="Last second of it.")] = None,
    name: Annotated[str, typer.Option(help="Of the scenario; else that of the file.")] = "",
    rules: Annotated[
        Path | None, typer.Option(help="Write the table in force at its beginning (JSON) here.")
    ] = None,
) -> None:
    """Make a scenario of what a robot of the simulation went through."""
    from pydantic import ValidationError

    from kompass.drills.runner.recorded_drive import NoScenario, scenario_of
    from kompass.drills.scenario_file import scenario_text
    from kompass.recorder.mcap.contents import NotMcap

    if not recording.is_file():
        raise CliError(BAD_INPUT, f"there is no recording {recording}; give an MCAP file")
    _check_new("-o", output)
    if rules is not None:
        _check_new("--rules", rules)
    try:
        found = scenario_of(recording, name or recording.stem, begin, end)
    except (NoScenario, NotMcap) as error:
        raise CliError(BAD_INPUT, f"{recording.name}: {error}") from None
    except ValidationError as error:
        first = error.errors()[0]
        where = str(first.get("ctx", {}).get("field") or ".".join(map(str, first["loc"])))
        raise CliError(BAD_INPUT, f"{recording.name}: {where}: {first['msg']}") from None
    if rules is not None and found.table is None:
        raise CliError(
            BAD_INPUT, f"--rules {rules}: {recording.name} holds no rules of then; leave it out"
        )
    output.write_text(scenario_text(found.scenario), encoding="utf-8")
    if rules is not None and found.table is not None:
        rules.write_text(found.table.model_dump_json(indent=1) + "\n", encoding="utf-8")
    typer.echo(f"{output}: {found.sentence}")
    for remark in found.remarks:
        typer.echo(f"  {remark}")


def _refuse_what_is_drawn(context: typer.Context, *options: str) -> None:
    """What only drawn drives have, where scenarios of files say it themselves."""
    for name in options:
        source = context.get_parameter_source(name)
        if source is not None and source.name == "COMMANDLINE":
            option = f"--{name.replace('_', '-')}"
            raise CliError(
                BAD_INPUT, f"{option}: the scenarios of --scenarios say it themselves; leave it out"
            )


def _check_new(option: str, file: Path) -> None:
    if file.exists():
        raise CliError(BAD_INPUT, f"{option} {file}: there is such a file; give another name")
    if not file.absolute().parent.is_dir():
        raise CliError(BAD_INPUT, f"{option} {file}: there is no folder {file.parent}")


def _scenario(
    looked: Looked,
    drive: str,
    files: Path | None,
    worlds: str,
    robot: str,
    faults: str,
    faults_per_drive: int,
    lasting: float,
    seed: int,
) -> Scenario:
    """The scenario of one drive, by its name or its number."""
    from kompass.drills.draw import repeated

    if files is not None:
        chosen, _ = _scenarios(
            looked, files, worlds, robot, faults, faults_per_drive, lasting, seed, 1
        )
        found = [each for each in chosen if each.name == drive]
        if len(chosen) == 1 and drive.isdecimal() and len(drive) < 6 and not found:
            found = [repeated(chosen[0], seed, max(int(drive) + 1, 2))[int(drive)]]
        _, _, number = drive.rpartition("-")
        if number.isdecimal() and len(number) < 6 and not found:
            # One of several drives of a scenario, with other noise; of one alone none is numbered.
            count = max(int(number) + 1, 2)
            several = (one for each in chosen for one in repeated(each, seed, count))
            found = [one for one in several if one.name == drive]
        if not found:
            known = ", ".join(each.name for each in chosen)
            raise CliError(BAD_INPUT, f"{drive}: {files} has no such scenario; it has {known}")
        return found[0]
    given, _, number = drive.rpartition("-")
    if not number.isdecimal() or (given and given != str(seed)):
        raise CliError(
            BAD_INPUT,
            f"{drive}: no drive of seed {seed} is called so; give a number, or {seed}-NUMBER, or "
            "the --scenario that it was read from",
        )
    chosen, _ = _scenarios(
        looked, None, worlds, robot, faults, faults_per_drive, lasting, seed, int(number) + 1
    )
    return chosen[-1]


def _table(option: str, file: Path | None) -> Table | None:
    """The table of a file; None for the recipe's own."""
    if file is None or str(file) == "recipe":
        return None
    if not file.is_file():
        raise CliError(BAD_INPUT, f"{option} {file}: there is no such file; give a table of rules")
    from kompass_console.rules_cli.table_file import TableFile

    return TableFile(file).table


def _name(file: Path | None, table: Table) -> TableName:
    from kompass.drills.report_json import TableName

    return TableName.of("recipe" if file is None or str(file) == "recipe" else file.name, table)


def _scenarios(
    looked: Looked,
    files: Path | None,
    worlds: str,
    robot: str,
    faults: str,
    faults_per_drive: int,
    lasting: float,
    seed: int,
    count: int | None,
) -> tuple[list[Scenario], DrawOptions | None]:
    """Those of files, or drawn ones with what they were drawn from."""
    from pydantic import ValidationError

    from kompass.drills.draw import USUAL_WORLDS, DrawOptions, check_targets, draw, repeated, roomy
    from kompass.drills.scenario_file import BadScenario, read_scenarios
    from kompass.simulation.faults.fault_names import UnknownFault
    from kompass.simulation.physics.robot_model import robot_names

    if files is not None:
        try:
            read = list(read_scenarios(files))
        except BadScenario as error:
            raise CliError(BAD_INPUT, f"--scenarios: {error}") from None
        for one in read:
            try:
                check_targets([fault.name for fault in one.faults], looked.targets)
            except UnknownFault as error:
                raise CliError(BAD_INPUT, f"--scenarios: scenario {one.name}: {error}") from None
        return [drive for one in read for drive in repeated(one, seed, count or 1)], None
    kind = robot or looked.robot
    if kind not in robot_names():
        known = ", ".join(robot_names())
        raise CliError(BAD_INPUT, f"--robot {kind}: there is no such robot; known are {known}")
    try:
        options = DrawOptions(
            worlds=tuple(_parts(worlds)) if worlds else USUAL_WORLDS,
            robot=kind,
            faults=looked.faults(_parts(faults), kind),
            half_width=looked.half_width,
            radius=looked.radius,
            faults_per_drive=faults_per_drive,
            lasting=lasting,
        )
    except UnknownFault as error:
        raise CliError(BAD_INPUT, f"--faults: {error}") from None
    except ValidationError as error:
        text = error.errors()[0]["msg"].removeprefix("Value error, ")
        raise CliError(BAD_INPUT, f"--worlds: {text}") from None
    if not worlds and (place := next(roomy(options), None)):
        options = options.model_copy(update={"worlds": (place,)})
    try:
        return [draw(seed, number, options) for number in range(count or DRIVES)], options
    except ValueError as error:
        raise CliError(BAD_INPUT, f"--worlds: {error}") from None


def _parts(text: str) -> list[str]:
    return [part.strip() for part in text.split(",") if part.strip()]


def _make(
    recipe: Path,
    scenarios: Sequence[Scenario],
    tried: tuple[TableName, Table | None],
    compared: tuple[TableName, Table | None] | None,
    jobs: int,
    differs: Callable[[str], object],
) -> tuple[list[DriveResult], list[DriveResult], CliError | None]:
    """What came of the drives under one table and under the other, and what has ended them before
    all were made: what was driven until then may have taken hours, and is not lost."""
    from kompass.drills.drive import DriveResult
    from kompass.drills.runner.worker import DriveFailed, Order, make_drives

    tables = [tried[1]] if compared is None else [tried[1], compared[1]]
    # Both tables of a scenario one after the other: a drill that is ended early compares, too.
    orders = [Order(recipe, scenario, table) for scenario in scenarios for table in tables]
    made: dict[int, DriveResult] = {}
    ended: CliError | None = None
    try:
        # Those that wait are not driven when this is left.
        with ended_as_by_hand(), closing(make_drives(orders, jobs, differs)) as drives:
            for index, text in with_progress(drives, len(orders)):
                made[index] = DriveResult.model_validate_json(text)
    except DriveFailed as error:
        ended = CliError(NOT_DRIVEN, str(error))
    except KeyboardInterrupt:
        ended = CliError(INTERRUPTED, f"ended by hand after {len(made)} of {len(orders)} drives")
        if made:
            begin = "\n" if sys.stderr.isatty() else ""  # of a terminal's line of progress
            typer.echo(f"{begin}ended by hand: comparing what was driven …", err=True)
    step = len(tables)
    # A scenario that was driven under one of two tables only compares nothing.
    whole = [
        first
        for first in range(0, len(orders), step)
        if all(each in made for each in range(first, first + step))
    ]
    against = [made[first + 1] for first in whole] if compared else []
    return [made[first] for first in whole], against, ended


def _tell(report: Report) -> None:
    """The sentence that matters, what came of the drives, and whether all is met."""
    for note in report.notes:
        typer.echo(f"! {note}")
    typer.echo(report.sentence)
    if report.comparison is not None:
        if report.comparison.chance:
            typer.echo(report.comparison.chance)
        for change in report.comparison.changes:
            typer.echo(f"  {change.scenario}: {change.text}")
    else:
        for drive in report.drives:
            broken = ", ".join(f.name for f in drive.scenario.faults) or "no fault"
            typer.echo(f"  {drive.scenario.name}  {broken}: {drive.why}")
    for summary, table in ((report.summary, ""), (report.summary_against, " of the other table")):
        for rule in () if summary is None else summary.rules:
            if rule.failed:
                times = f"{rule.failed} of its {rule.firings} firings"
                typer.echo(f"  {rule.rule_id}{table}: {times} did not do what they should")
    for drive in (*report.drives, *report.drives_against):
        for fault in drive.refused:
            what = f"{fault.name} did not begin at {round(fault.at, 2):g} s"
            typer.echo(f"  {drive.scenario.name}: {what}: {fault.reason}")
    for drive in report.drives:
        for each in drive.broken:
            typer.echo(f"  {drive.scenario.name}: {each.invariant} at {each.at:g} s: {each.text}")
    for requirement in report.requirements:
        typer.echo(f"  {requirement.text}")


def recipe_first(arguments: Sequence[str]) -> list[str]:
    """``drill RECIPE`` is ``drill run RECIPE``."""
    given = list(arguments)
    words = {command.name for command in app.registered_commands} | {"-h", "--help"}
    if given[:1] == ["drill"] and len(given) > 1 and given[1] not in words:
        given.insert(1, "run")
    return given
