"""A request that does not fit its schema, in a sentence and a remedy."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from itertools import groupby
from typing import Any

from kompass.invalid import invalid_of

_VALUE = 60  # characters of a value that is shown
_STRUCTURE = ("missing", "extra_forbidden")
_PARTS = ("body", "query", "path", "header", "cookie")
_Item = Mapping[str, Any]


def told_invalid(errors: Sequence[_Item]) -> tuple[str, str]:
    """What is wrong with a request and what to do about it.

    Parameters
    ----------
    errors
        What its validation found: at least one, the places beginning with the part of the request.
    """
    ways = _nearest(errors)
    missing = [[".".join(_steps(each)) for each in way] for way in ways]
    if len(ways) > 1 and all(each["type"] == "missing" for way in ways for each in way):
        lacks = ", or ".join(" and ".join(way) for way in missing)
        return f"The request says too little: it lacks {lacks}.", "Add what is missing."
    first = ways[0][0]
    part = str(first["loc"][0])
    field = ".".join(_steps(first))
    if first["type"] == "missing" and not field:
        return "The request has no body.", "Send one, as JSON."
    if first["type"] == "json_invalid":
        why = first.get("ctx", {}).get("error", "it breaks off")
        return f"The request's body is no JSON: {why}.", "Correct it, and send it again."
    if first["type"] == "missing":
        return f"The request lacks {field}.", "Add it, and send it again."
    if first["type"] == "extra_forbidden":
        return (
            f"The request has a field {field}, and there is none here.",
            "Leave it out, or correct its name.",
        )
    wrong = invalid_of(first)
    what = f"The request's {field or part} cannot be {_shown(wrong.value)}: {wrong.text}."
    return what, "Correct it, and send it again."


def _nearest(errors: Sequence[_Item]) -> list[list[_Item]]:
    """What is wrong with those of the ways to write a body that the request comes nearest to.

    Where a body may be one of several models, each complains of it, under its own name.
    """
    if not all(_model_of(each) for each in errors):
        return [list(errors)]
    ways = [list(way) for _, way in groupby(errors, _model_of)]
    fewest = min(map(_off, ways))
    return [way for way in ways if _off(way) == fewest]


def _off(way: Iterable[_Item]) -> int:
    return sum(each["type"] in _STRUCTURE for each in way)


def _model_of(item: _Item) -> str:
    """The model whose complaint it is; empty where there is one only. Fields are written small."""
    steps = item["loc"][1:2]
    return steps[0] if steps and str(steps[0])[:1].isupper() else ""


def _steps(item: _Item) -> list[str]:
    steps = list(item["loc"])
    if steps and steps[0] in _PARTS:
        del steps[0]
    if _model_of(item):
        del steps[0]
    return [str(step) for step in steps]


def _shown(value: Any) -> str:
    text = json.dumps(value, ensure_ascii=False, default=str)
    return text if len(text) <= _VALUE else text[: _VALUE - 1] + "…"
