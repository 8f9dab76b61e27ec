"""The recipe changed while people had edited its rules: lay the edits over the new recipe."""

from collections.abc import Iterable
from typing import Any

from pydantic import ValidationError

from kompass.rulebook.diff import field_changes
from kompass.rulebook.views.recipe_code import functions_in, functions_of
from kompass.rulebook.views.wording import describe_actions, seconds
from kompass.rules.schema.describe import describe
from kompass.rules.schema.events import Event
from kompass.rules.schema.table import Rule, Source, Table, rule_hash

_FIELDS = ("name", "enabled", "severity", "lane", "shadow", "note", "actions")


def merge(old_recipe: Table, edited: Table, new_recipe: Table) -> tuple[Table, list[str]]:
    """Return the new recipe's table with the edits laid over it, and what could not be.

    Edits are laid over rule by rule and field by field. Where both changed the same field the new
    recipe holds, and a sentence says so; but a rule that a person switched off stays off. Rules
    that the recipe protects are as the recipe says.

    Parameters
    ----------
    old_recipe
        From which the edits began.
    edited
        The last table that a person confirmed.
    new_recipe
        What the recipe declares today.
    """
    merging = _Merging(old_recipe, edited, new_recipe)
    return merging.table(), merging.conflicts


class _Merging:
    def __init__(self, old: Table, edited: Table, new: Table) -> None:
        self.old = {rule.id: rule for rule in old.rules}
        self.edited = {rule.id: rule for rule in edited.rules}
        self.new = {rule.id: rule for rule in new.rules}
        self.functions = functions_of(new)
        self.conflicts: list[str] = []
        self.made: dict[str, Rule] = {}
        for rule in new.rules:
            self._of_recipe(rule)
        for rule in edited.rules:
            self._of_person(rule)

    def table(self) -> Table:
        return Table(rules=tuple(self.made[rule_id] for rule_id in self._order()))

    def _tell(self, rule: Rule, text: str) -> None:
        self.conflicts.append(f"'{rule.name or rule.id}': {text}")

    # -- rules of the new recipe --------------------------------------------------------------

    def _of_recipe(self, new: Rule) -> None:
        old, edited = self.old.get(new.id), self.edited.get(new.id)
        if old is None:
            self.made[new.id] = new
            if edited is not None and not _alike(edited, new):
                self._beside(edited)
        elif edited is None:
            self._removed(old, new)
        elif new.protected:
            self.made[new.id] = new
            if field_changes(old, edited) and field_changes(edited, new):
                self._tell(new, "the recipe protects it, so your changes to it are left out")
        else:
            self.made[new.id] = self._merged(old, edited, new)

    def _beside(self, edited: Rule) -> None:
        """Keep a rule of a person whose id the recipe now uses for one of its own."""
        rule_id = self._free(f"{edited.id[:90]}-edited")
        self.made[rule_id] = edited.model_copy(update={"id": rule_id, "enabled": False})
        self._tell(
            edited,
            f"the recipe now has a rule of its own with the id '{edited.id}'; yours is kept as "
            f"'{rule_id}', switched off",
        )

    def _free(self, wanted: str) -> str:
        taken = {*self.made, *self.edited, *self.new}
        rule_id, number = wanted, 2
        while rule_id in taken:
            rule_id, number = f"{wanted}-{number}", number + 1
        return rule_id

    def _removed(self, old: Rule, new: Rule) -> None:
        if new.protected:
            self.made[new.id] = new
            self._tell(new, "you had removed it, but the recipe protects it; it is back")
        elif rule_hash(old) != rule_hash(new):
            self.made[new.id] = new.model_copy(update={"enabled": False, "source": "edited"})
            self._tell(
                new,
                "you had removed it, and the recipe has changed it since; it is back, switched off",
            )

    def _merged(self, old: Rule, edited: Rule, new: Rule) -> Rule:
        fields: dict[str, Any] = {"id": new.id, "protected": new.protected}
        for name in _FIELDS:
            values = getattr(old, name), getattr(edited, name), getattr(new, name)
            fields[name] = self._field(name, values, new)
        if not edited.enabled and old.enabled:
            fields["enabled"] = False
        event: dict[str, Any] = {}
        for name in Event.model_fields:
            values = getattr(old.event, name), getattr(edited.event, name), getattr(new.event, name)
            event[name] = self._field(name, values, new)
        try:
            made = Rule(**fields, event=Event(**event), source=_hand(edited))
        except ValidationError as error:
            problem = error.errors()[0]["msg"].removeprefix("Value error, ")
            self._tell(new, f"your changes no longer fit the recipe's rule ({problem}); left out")
            return new.model_copy(update={"enabled": fields["enabled"]})
        return new if _alike(made, new) else made

    def _field(self, name: str, values: tuple[Any, Any, Any], rule: Rule) -> Any:
        old, edited, new = values
        if _same(edited, old) or _same(edited, new):
            return new
        if _same(new, old):
            return edited
        if name not in ("enabled", "note"):
            texts = [_text(name, value) for value in (new, edited)]
            self._tell(
                rule,
                f"both changed {_WORDS.get(name, name)}: the recipe says {texts[0]}, you said "
                f"{texts[1]}; the recipe's holds",
            )
        return new

    # -- rules of a person --------------------------------------------------------------------

    def _of_person(self, edited: Rule) -> None:
        if edited.id in self.new:
            return
        old = self.old.get(edited.id)
        if old is not None:
            changes = field_changes(old, edited)
            if changes:
                names = ", ".join(change.field for change in changes)
                self._tell(
                    edited, f"the recipe no longer has it; your changes ({names}) are left out"
                )
            return
        missing = sorted(set(functions_in(edited)) - self.functions)
        if missing:
            self._tell(edited, f"it needs {', '.join(missing)}, which the recipe no longer has")
            return
        self.made[edited.id] = edited

    # -- the order ----------------------------------------------------------------------------

    def _order(self) -> list[str]:
        """Return the ids in the recipe's order, or in a person's where only a person changed it."""
        common = [i for i in self.old if i in self.edited and i in self.new]
        theirs = [i for i in self.new if i in common]
        if theirs == common:
            return _woven(self.edited, self.new, self.made)
        return _woven(self.new, self.edited, self.made)


def _woven(first: Iterable[str], second: Iterable[str], wanted: Iterable[str]) -> list[str]:
    """Return all that is wanted, in the order of ``first``; what only ``second`` has, behind what
    stands before it there."""
    made = set(wanted)
    order = [rule_id for rule_id in first if rule_id in made]
    known = set(order)
    last: str | None = None
    for rule_id in second:
        if rule_id not in made:
            continue
        if rule_id not in known:
            order.insert(0 if last is None else order.index(last) + 1, rule_id)
            known.add(rule_id)
        last = rule_id
    return order + [rule_id for rule_id in wanted if rule_id not in known]


def _hand(edited: Rule) -> Source:
    """Return who had a hand in a rule of the recipe before, and so has one in what comes of it."""
    return "edited" if edited.source == "recipe" else edited.source


def _alike(a: Rule, b: Rule) -> bool:
    return a.model_copy(update={"source": b.source}) == b


def _same(a: Any, b: Any) -> bool:
    return bool(a == b) and type(a) is type(b)


_WORDS = {"condition": "when it fires", "actions": "what it does", "clear": "when it clears"}


def _text(name: str, value: Any) -> str:
    if name in ("condition", "clear"):
        return "none" if value is None else describe(value)
    if name in ("hold", "cooldown"):
        return seconds(value)
    if name == "actions":
        return describe_actions(value)
    kind = getattr(value, "kind", None)
    return str(kind or getattr(value, "name", value)).lower()
