"""Whether a drive that was made twice went the same way twice."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import zip_longest

_LONGEST = 160  # characters of a fact that are told
CAUSES = (
    "time.time() or datetime.now() in a callback of a component, threads and sockets of its own, "
    "os.urandom() and the like"
)


def difference(scenario: str, first: Sequence[str], second: Sequence[str]) -> str:
    """What differs first, in a sentence; empty when nothing does.

    Parameters
    ----------
    first, second
        The facts of both, as texts, in the order in which they were observed.
    """
    for one, other in zip_longest(first, second, fillvalue=""):
        if one != other:
            return (
                f"The recipe is not the same twice: drive {scenario}, made twice, differs from "
                f"{_time(one or other)} s on, where {_short(one)} was once and {_short(other)} the "
                f"other time. Something in it asks for what no seed decides; usually {CAUSES}. "
                "What is told of these drives may be chance."
            )
    return ""


def _time(fact: str) -> str:
    found = re.search(r"at=([0-9.e-]+)", fact)
    return f"{round(float(found[1]), 6):g}" if found else "?"


def _short(fact: str) -> str:
    """``Motion(at=8.2, x=-1.69)`` as people read it: "motion (x -1.69)"."""
    if not fact:
        return "nothing more"
    if (parts := re.fullmatch(r"(\w+)\((?:at=[0-9.e-]+(?:, )?)?(.*)\)", fact)) is not None:
        kind = re.sub(r"(?<!^)([A-Z])", r" \1", parts[1]).lower()
        values = re.sub(r"\b(\w+)=", r"\1 ", parts[2])
        fact = f"{kind} ({values})" if values else kind
    return fact if len(fact) <= _LONGEST else f"{fact[:_LONGEST]}…"
