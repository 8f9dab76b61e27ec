"""Whether the answer of a service says that what was asked for was not done.

ROS has no field for that, only customs. These are taken for a refusal, and nothing else is:

- ``bool success`` that is false (std_srvs and most others); in a list of them, any that is;
- ``result`` that is a whole number other than the ``RESULT_SUCCESS`` (or ``SUCCESS``) that the same
  answer defines (nav2_msgs/LoadMap, slam_toolbox);
- ``bool result`` that is false, of nav2_msgs only (SaveMap): elsewhere it may answer a question;
- ``rcl_interfaces/SetParametersResult`` that is not ``successful``.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

_GOOD = ("RESULT_SUCCESS", "SUCCESS")
# Where services say in words what went wrong.
_WORDS = ("message", "error_msg", "error_message", "status_message", "reason")
_PARAMETERS = "rcl_interfaces/SetParametersResult"


def refusal(answer: Any) -> str:
    """Why a service did not do what it was asked for.

    Empty if it did, or if its answer has nothing that says so.
    """
    return next(_complaints(answer, answer.get_fields_and_field_types()), "")


def _complaints(answer: Any, types: dict[str, str]) -> Iterator[str]:
    kind = types.get("success")
    if (kind == "boolean" and not answer.success) or (
        kind == "sequence<boolean>" and not all(answer.success)
    ):
        yield _words(answer) or "success is false"
    kind = types.get("result", "")
    if kind.removeprefix("u").startswith("int"):
        yield from _code(answer)
    elif kind == "boolean" and type(answer).__module__.startswith("nav2_msgs."):
        if not answer.result:
            yield _words(answer) or "result is false"
    elif kind == _PARAMETERS:
        yield from _parameters([answer.result])
    if types.get("results") == f"sequence<{_PARAMETERS}>":
        yield from _parameters(answer.results)


def _code(answer: Any) -> Iterator[str]:
    """A number that the answer itself calls no success, by the name that it gives it."""
    kind = type(answer)
    good = next((getattr(kind, name) for name in _GOOD if hasattr(kind, name)), None)
    if good is None or answer.result == good:
        return
    names = (
        name
        for name in dir(kind)
        if name.isupper() and getattr(kind, name) == answer.result and name not in _GOOD
    )
    yield _words(answer) or next(names, f"result is {answer.result}")


def _parameters(results: Any) -> Iterator[str]:
    wrong = [each for each in results if not each.successful]
    if wrong:
        yield "; ".join(each.reason for each in wrong if each.reason) or "a parameter was not set"


def _words(answer: Any) -> str:
    for name in _WORDS:
        said = getattr(answer, name, "")
        text = said if isinstance(said, str) else "; ".join(each for each in said if each)
        if text:
            return text
    return ""
