"""Whether rules are as the recipe has them: worked out, and never taken from who hands them in."""

from kompass.rules.schema.identity_cache import IdentityCache
from kompass.rules.schema.interned import interned
from kompass.rules.schema.table import Rule, Table, rule_hash


def with_sources(table: Table, recipe: Table) -> Table:
    """Return a table in which every ``source`` is true, whatever it said of itself.

    A rule is the recipe's if the recipe has one of this id that does the same and has the same name
    and note; all others were made or changed by a person.
    """
    own = {rule.id: rule for rule in recipe.rules}
    rules = tuple(_with_source(rule, own.get(rule.id)) for rule in table.rules)
    same = all(one is other for one, other in zip(rules, table.rules, strict=True))
    return table if same else Table(rules=rules)


def _with_source(rule: Rule, own: Rule | None) -> Rule:
    same = (
        own is not None
        and rule_hash(own) == rule_hash(rule)
        and (own.name, own.note) == (rule.name, rule.note)
    )
    return rule if (rule.source == "recipe") == same else _of_the_other(rule)


def _other(rule: Rule) -> Rule:
    source = "edited" if rule.source == "recipe" else "recipe"
    return interned(rule.model_copy(update={"source": source}))


_of_the_other = IdentityCache[Rule, Rule](_other)
