"""A drill as one document: what was asked, every drive judged, and what it comes to.

The same seeds and tables give the same bytes on any machine: there is no real time in it, and
nothing of who ran it where.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import Annotated, Literal, Self

from pydantic import ConfigDict, Field, ValidationError, field_validator

from kompass.drills.compare import Comparison, compare
from kompass.drills.draw import DrawOptions, fits
from kompass.drills.drive import DriveResult
from kompass.drills.names import natural
from kompass.drills.requirement import Checked, Requirement, check_requirements
from kompass.drills.summary import Summary, summarize
from kompass.rules.schema.model import Model
from kompass.rules.schema.table import Table, table_hash
from kompass.simulation.worlds.registry import world

SCHEMA: Literal["kompass-drill/1"] = "kompass-drill/1"


class TableName(Model):
    """Which rules were in force: what people call the table, and what identifies it.

    Attributes
    ----------
    hash
        Over what the rules do and their order (:func:`kompass.rules.schema.table.table_hash`).
    """

    name: str
    hash: str
    rules: int

    @classmethod
    def of(cls, name: str, table: Table) -> Self:
        """The name of a table."""
        return cls(name=name, hash=table_hash(table), rules=len(table.rules))


class RequirementResult(Model):
    """A requirement, and whether it was met."""

    requirement: str
    met: bool
    text: str


class Report(Model):
    """A drill.

    Attributes
    ----------
    recipe
        What drove; a name, no path.
    table, drives, summary
        The rules that were tried, and what came of them.
    against, drives_against, summary_against, comparison
        The other rules, if there are any, on the same scenarios.
    seed, options
        What the scenarios were drawn from. Those of a person's own have no options, and a seed
        where each was driven several times, with other noise.
    requirements
        Checked on ``summary``.
    notes
        What a person must know to judge all of it, in sentences.
    """

    model_config = ConfigDict(
        frozen=True, extra="forbid", allow_inf_nan=False, validate_by_name=True
    )

    schema_version: Annotated[Literal["kompass-drill/1"], Field(alias="schema")] = SCHEMA
    recipe: str
    seed: int | None = None
    options: DrawOptions | None = None
    table: TableName
    against: TableName | None = None
    comparison: Comparison | None = None
    summary: Summary
    summary_against: Summary | None = None
    requirements: tuple[RequirementResult, ...] = ()
    notes: tuple[str, ...] = ()
    drives: tuple[DriveResult, ...]
    drives_against: tuple[DriveResult, ...] = ()

    @field_validator("recipe")
    @classmethod
    def _is_no_path(cls, name: str) -> str:
        if "/" in name or "\\" in name:
            raise ValueError(f"{name!r} is a path of some machine; give the name of the file alone")
        return name

    @property
    def robots(self) -> str:
        """Names of the embedded robots that drove it."""
        return ", ".join(sorted({drive.scenario.robot for drive in self.drives}))

    @property
    def sentence(self) -> str:
        """The one that matters."""
        if self.comparison is not None:
            return self.comparison.sentence
        found = self.summary
        if not found.drives:
            return "No drive was made."
        if not found.disturbed:
            spared = all(drive.spared for drive in self.drives)
            calm = "No fault disturbed any drive"
            if spared:
                calm = "Every fault began when the robot had arrived"
            if found.came_through < found.drives:
                calm += f"; reaches its goals in {found.came_through} of {found.drives}"
            return f"{calm}{self._stopped}."
        said = f"Recovers in {found.recovered} of {found.disturbed} disturbed drives"
        if found.contacts:
            said += f"; {found.contacts} contact{'s' if found.contacts > 1 else ''}"
        return f"{said}{self._stopped}."

    @property
    def _stopped(self) -> str:
        found = self.summary
        if not found.left_stopped:
            return ""
        return f"; ends with STOP in {found.left_stopped} of {found.drives}"


def make_report(
    *,
    recipe: str,
    table: TableName,
    drives: Sequence[DriveResult],
    against: TableName | None = None,
    drives_against: Sequence[DriveResult] = (),
    seed: int | None = None,
    options: DrawOptions | None = None,
    requirements: Sequence[Requirement] = (),
    notes: Sequence[str] = (),
    names: Mapping[str, str] = MappingProxyType({}),
) -> Report:
    """Sum up a drill; the order in which the drives were finished makes no difference.

    ``names`` are those by which people know the rules of both tables.

    Raises
    ------
    ValueError
        The drives under the two tables are not of the same scenarios, or ``recipe`` is a path.
    """
    summary = summarize(drives)
    return Report(
        recipe=recipe,
        seed=seed,
        options=options,
        table=table,
        against=against,
        comparison=None if against is None else compare(drives_against, drives, names),
        summary=summary,
        summary_against=None if against is None else summarize(drives_against),
        requirements=tuple(map(_result, check_requirements(requirements, summary))),
        notes=(*notes, *_left_out(options, drives)),
        drives=_sorted(drives),
        drives_against=_sorted(drives_against),
    )


def _left_out(options: DrawOptions | None, drives: Sequence[DriveResult]) -> Iterator[str]:
    """That there were fewer drives than faults."""
    if options is not None:
        places = [world(name) for name in options.worlds]
        given = {name for name in options.faults if any(fits(name, place) for place in places)}
        drawn = given & {fault.name for drive in drives for fault in drive.scenario.faults}
        if drawn != given:
            # Each world has its turn of as many drives as there are faults, whether all fit or not.
            several = len(options.worlds) > 1
            whole = len(options.faults) * len(options.worlds) if several else len(given)
            yield (
                f"{len(drawn)} of {len(given)} faults were drawn in these drives, and the others "
                f"not tried; {whole} drives have each of them"
            )


def report_json(report: Report) -> str:
    """A report as JSON, in which a person finds their way: indented, with a line at the end."""
    data = report.model_dump(mode="json", by_alias=True)
    return json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def read_report(text: str) -> Report:
    """The report of such a text.

    Raises
    ------
    ValueError
        It is none, or one of a version that is not read here.
    """
    try:
        data = json.loads(text)
    except json.JSONDecodeError as error:
        raise ValueError(
            f"line {error.lineno}: {error.msg}; give a file that a drill has written"
        ) from None
    found = data.get("schema") if isinstance(data, dict) else None
    if found != SCHEMA:
        raise ValueError(
            f"schema is {found!r}; read here is {SCHEMA!r}: give the report of a drill, or make it "
            "again"
        )
    try:
        return Report.model_validate_json(text)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        where = ".".join(map(str, first["loc"]))
        raise ValueError(f"{where}: {first['msg']}; make the report again") from None


def _sorted(drives: Sequence[DriveResult]) -> tuple[DriveResult, ...]:
    return tuple(sorted(drives, key=lambda drive: natural(drive.scenario.name)))


def _result(checked: Checked) -> RequirementResult:
    return RequirementResult(
        requirement=str(checked.requirement), met=checked.met, text=checked.text
    )
