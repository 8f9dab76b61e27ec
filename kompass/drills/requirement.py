"""What a drill must come to, as after ``--require``: ``recovered >= 0.95, contacts == 0``.

A requirement compares one number of a summary: ``NAME OPERATOR NUMBER``. A comma means *and*. A
number with a decimal point or a percent sign is a share, a whole number a count; for a name of
seconds it is seconds either way.
"""

from __future__ import annotations

import difflib
import operator
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal, TypeAlias

from kompass.drills.summary import Summary

Kind: TypeAlias = Literal["share", "count", "seconds"]
_Compares = Callable[[Fraction, Fraction], bool]
OPERATORS: dict[str, _Compares] = {
    ">=": operator.ge,
    "<=": operator.le,
    "==": operator.eq,
    "!=": operator.ne,
    ">": operator.gt,
    "<": operator.lt,
}
_ALL = "of all drives"
_DISTURBED = "of the drives that a fault disturbed"
# Drives that can be counted, or taken as a share, and of which.
SHARES: dict[str, tuple[Callable[[Summary], int], str]] = {
    "came_through": (lambda s: s.came_through, _ALL),
    "arrived": (lambda s: s.outcomes["arrived"], _ALL),
    "disturbed": (lambda s: s.disturbed, _ALL),
    "recovered": (lambda s: s.recovered, _DISTURBED),
    "stood": (lambda s: s.outcomes["stood"], _ALL),
    "gave_up": (lambda s: s.outcomes["gave_up"], _ALL),
    "stopped": (lambda s: s.outcomes["stopped"], _ALL),
    "out_of_time": (lambda s: s.outcomes["out_of_time"], _ALL),
    "stood_silent": (lambda s: s.outcomes["stood_silent"], _ALL),
    "touched": (lambda s: s.outcomes["contact"], _ALL),
    "left_stopped": (lambda s: s.left_stopped, _ALL),
}
COUNTS: dict[str, Callable[[Summary], int]] = {
    "drives": lambda s: s.drives,
    "contacts": lambda s: s.contacts,
    "invariants_broken": lambda s: s.invariants_broken,
    "actions_failed": lambda s: s.actions_failed,
}
SECONDS: dict[str, Callable[[Summary], float | None]] = {
    "time_to_goal_median": lambda s: s.time_to_goal_median,
    "time_to_goal_max": lambda s: s.time_to_goal_max,
    "recovery_median": lambda s: s.recovery_median,
    "recovery_max": lambda s: s.recovery_max,
}
NAMES = (*SHARES, *COUNTS, *SECONDS)
_PART = re.compile(
    r"(?P<name>[A-Za-z_]\w*)\s*(?P<operator>[<>=!]+)\s*(?P<number>\S+?)\s*(?P<unit>%|s)?"
)
_NUMBER = re.compile(r"[0-9]+(\.[0-9]+)?")
_DIGITS = 9  # before the point, and behind it


class BadRequirement(ValueError):
    """It cannot be read, or can never mean anything; the message tells the remedy."""


@dataclass(frozen=True)
class Requirement:
    """One comparison.

    Attributes
    ----------
    name
        One of ``NAMES``.
    operator
        One of ``OPERATORS``.
    value
        What it is compared with, exactly; a share is 0 to 1.
    kind
        What the number is.
    """

    name: str
    operator: str
    value: Fraction
    kind: Kind

    def __str__(self) -> str:
        return f"{self.name} {self.operator} {_number(self.value, self.kind)}"


@dataclass(frozen=True)
class Checked:
    """A requirement, and whether a summary meets it; ``text`` says so, and by how much not."""

    requirement: Requirement
    met: bool
    text: str


def parse_requirements(text: str) -> tuple[Requirement, ...]:
    """Read requirements, separated by commas.

    Raises
    ------
    BadRequirement
        Naming the part, what is wrong with it, and what could stand there.
    """
    parts = [part.strip() for part in text.split(",")]
    if not any(parts):
        raise BadRequirement("nothing is required; give for example 'recovered >= 0.95'")
    if not all(parts):
        raise BadRequirement(f"{text!r} has a comma with nothing beside it; leave it out")
    return tuple(map(_parse, parts))


def refuse_impossible(requirements: Sequence[Requirement], drives: int) -> None:
    """Refuse what so many drives cannot come to, whatever becomes of them.

    Raises
    ------
    BadRequirement
        Naming the requirement.
    """
    for one in requirements:
        if one.kind != "count" or (one.name not in SHARES and one.name != "drives"):
            continue
        possible = range(drives, drives + 1) if one.name == "drives" else range(drives + 1)
        if not any(OPERATORS[one.operator](Fraction(count), one.value) for count in possible):
            raise BadRequirement(
                f"'{one}' cannot be met: there are {drives} drives. Make more, or give a share, "
                "with a point or as per cent"
            )


def check_requirements(requirements: Sequence[Requirement], summary: Summary) -> list[Checked]:
    """Which requirements a summary meets.

    One that compares something of which there is nothing (a median of no drives, a share of no
    drives) is not met.
    """
    return [_check(requirement, summary) for requirement in requirements]


def exit_code(checked: Sequence[Checked]) -> int:
    """What a program ends with: 0 when all are met, else 1."""
    return 0 if all(one.met for one in checked) else 1


def _parse(part: str) -> Requirement:
    match = _PART.fullmatch(part)
    if match is None:
        raise BadRequirement(
            f"{part!r} is no requirement; give a name, a comparison and a number, as "
            f"'recovered >= 0.95', and a comma before the next. Names: {', '.join(NAMES)}"
        )
    name, sign, digits, unit = match.group("name", "operator", "number", "unit")
    if name not in NAMES:
        near = difflib.get_close_matches(name, NAMES, n=1, cutoff=0.6)
        hint = f"did you mean {near[0]!r}? " if near else ""
        raise BadRequirement(f"{part!r}: there is no {name!r}; {hint}known are {', '.join(NAMES)}")
    if sign not in OPERATORS:
        hint = "for equal write ==" if sign == "=" else f"give one of {' '.join(OPERATORS)}"
        raise BadRequirement(f"{part!r}: {sign!r} is no comparison; {hint}")
    if not _NUMBER.fullmatch(digits):
        raise BadRequirement(f"{part!r}: {digits!r} is no number of 0 or more; give one, as 0.95")
    if max(map(len, digits.split("."))) > _DIGITS:
        raise BadRequirement(
            f"{part!r}: {digits!r} has too many digits; give at most {_DIGITS} before the point, "
            "and as many behind it"
        )
    return _made(part, name, sign, digits, unit or "")


def _made(part: str, name: str, sign: str, digits: str, unit: str) -> Requirement:
    value = Fraction(digits)
    if name in SECONDS:
        if unit == "%":
            raise BadRequirement(f"{part!r}: {name} is a time; give seconds, as 30")
        return Requirement(name, sign, value, "seconds")
    if unit == "s":
        raise BadRequirement(f"{part!r}: {name} is no time; leave out the 's'")
    if unit != "%" and "." not in digits:
        return Requirement(name, sign, value, "count")
    if name in COUNTS:
        raise BadRequirement(f"{part!r}: {name} is a count, of nothing; give a whole number")
    share = value / 100 if unit == "%" else value
    if share > 1:
        raise BadRequirement(
            f"{part!r}: no share is above 1; give 0.0 to 1.0 or 0 % to 100 %, or a whole number "
            "of drives"
        )
    return Requirement(name, sign, share, "share")


def _check(requirement: Requirement, summary: Summary) -> Checked:
    name = requirement.name
    if name in SECONDS:
        seconds = SECONDS[name](summary)
        if seconds is None:
            what = "recovered" if name.startswith("recovery") else "came through"
            return Checked(requirement, False, f"{requirement}: not met, for no drive {what}")
        return _compared(requirement, Fraction(str(seconds)), f"{seconds:g} s", " s")
    if requirement.kind == "count":
        count = SHARES[name][0](summary) if name in SHARES else COUNTS[name](summary)
        return _compared(requirement, Fraction(count), str(count), "")
    counted, of = SHARES[name]
    total = summary.disturbed if of == _DISTURBED else summary.drives
    if not total:
        return Checked(requirement, False, f"{requirement}: not met, for it is a share {of}: none")
    share = Fraction(counted(summary), total)
    told = f"{float(share):.3f} ({counted(summary)} of {total})"
    return _compared(requirement, share, told, "")


def _compared(requirement: Requirement, value: Fraction, told: str, unit: str) -> Checked:
    met = OPERATORS[requirement.operator](value, requirement.value)
    if met:
        return Checked(requirement, True, f"{requirement}: met, it is {told}")
    off = float(abs(value - requirement.value))
    by = f", off by {off:.3g}{unit}" if off else ""
    return Checked(requirement, False, f"{requirement}: not met, it is {told}{by}")


def _number(value: Fraction, kind: Kind) -> str:
    """As it can be read again, and as what it is."""
    # Each was written with at most _DIGITS decimals, and a percentage has two more.
    digits = f"{value.numerator * 10**11 // value.denominator:012d}"
    whole, decimals = digits[:-11], digits[-11:].rstrip("0")
    if kind == "share":
        return f"{whole}.{decimals or '0'}"
    return f"{whole}.{decimals}" if decimals else whole
