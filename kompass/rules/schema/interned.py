"""Rules of the same content as one object, so that they share one entry in every cache."""

from weakref import WeakValueDictionary

from kompass.rules.schema.identity_cache import IdentityCache
from kompass.rules.schema.table import Rule, Table

_living: WeakValueDictionary[str, Rule] = WeakValueDictionary()
text_of = IdentityCache[Rule, str](lambda rule: rule.model_dump_json())


def interned(rule: Rule) -> Rule:
    """Return the living rule with all the same fields; the given one if it is the first."""
    return _living.setdefault(text_of(rule), rule)


def read_rule(text: str) -> Rule:
    """Return the rule of a JSON text; one that lives already is not validated a second time.

    Raises
    ------
    pydantic.ValidationError
        If the text is no rule.
    """
    known = _living.get(text)
    return interned(Rule.model_validate_json(text)) if known is None else known


def interned_table(table: Table) -> Table:
    """Return a table of the same content, made of rules that live already where it can be."""
    rules = tuple(map(interned, table.rules))
    same = all(one is other for one, other in zip(rules, table.rules, strict=True))
    return table if same else Table(rules=rules)


def table_text(table: Table) -> str:
    """Return a table as JSON, as ``model_dump_json`` writes it."""
    return f'{{"rules":[{",".join(map(text_of, table.rules))}]}}'
