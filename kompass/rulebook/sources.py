"""Who had a hand in rules: worked out, and never taken from who hands them in."""

from collections.abc import Sequence

from kompass.rules.schema.interned import interned
from kompass.rules.schema.table import Rule, Source, Table, rule_hash

# What an operator may do to a rule without having had a hand in what it does.
_SWITCHES = {"enabled": True, "shadow": False, "protected": False}


def with_sources(table: Table, recipe: Table, role: str, known: Sequence[Table] = ()) -> Table:
    """Return a table in which every ``source`` is true, whatever it said of itself.

    A rule is the recipe's if the recipe has one of this id that does the same and has the same name
    and note. One that was known and does what it did keeps its source; to switch it off or on,
    into shadow or out of it, is to do the same. Of all others the source is that of who asks, or of
    who had a hand in it before and may do less.

    Parameters
    ----------
    recipe
        The table that the recipe declares.
    role
        Of who hands the table in.
    known
        Tables whose sources are true already; the first that has a rule of that id counts.
    """
    own = {rule.id: rule for rule in recipe.rules}
    was = {rule.id: rule for before in reversed(known) for rule in before.rules}
    rules = tuple(
        _with_source(rule, own.get(rule.id), was.get(rule.id), role) for rule in table.rules
    )
    same = all(one is other for one, other in zip(rules, table.rules, strict=True))
    return table if same else Table(rules=rules)


def _with_source(rule: Rule, own: Rule | None, was: Rule | None, role: str) -> Rule:
    source = _source(rule, own, was, role)
    if rule.source == source:
        return rule
    return interned(rule.model_copy(update={"source": source}))


def _source(rule: Rule, own: Rule | None, was: Rule | None, role: str) -> Source:
    if (
        own is not None
        and rule_hash(own) == rule_hash(rule)
        and (own.name, own.note) == (rule.name, rule.note)
    ):
        return "recipe"
    asked: Source = "engineer" if role == "engineer" else "edited"
    if was is None or was.source == "recipe":
        return asked
    if rule_hash(was) == rule_hash(rule) or _deed(was) == _deed(rule):
        return was.source
    return "edited" if "edited" in (asked, was.source) else "engineer"


def _deed(rule: Rule) -> str:
    return rule_hash(rule.model_copy(update=_SWITCHES))
