"""Something wrong with a rule, said so that a person can mend it."""

from typing import Any, NamedTuple


class Problem(NamedTuple):
    """Something wrong with a rule.

    Attributes
    ----------
    rule_id
        The rule.
    field
        Where in the rule, e.g. ``event.condition.conditions[1].signal.path``.
    value
        What stands there.
    text
        What is wrong with it.
    remedy
        What to write instead.
    code
        Short and stable, for programs.
    """

    rule_id: str
    field: str
    value: Any
    text: str
    remedy: str
    code: str = "does-not-fit"

    def __str__(self) -> str:
        return f"rule '{self.rule_id}': {self.field} = {self.value!r}: {self.text}; {self.remedy}"
