"""How long what has happened matters to a rule."""

from kompass.rules.engine.compiled_table import CompiledTable, RulePlan
from kompass.rules.schema.conditions import Absent, Rate, timeout_of


def memory(compiled: CompiledTable, plan: RulePlan) -> float:
    """Seconds for which what was before a recording may still matter to a rule."""
    event = plan.rule.event
    longest = max(event.hold, event.cooldown, event.max_rate.window if event.max_rate else 0.0)
    for _, index in (*plan.leaves, *plan.clear_leaves):
        condition = compiled.leaves[index].condition
        if isinstance(condition, Absent):
            longest = max(longest, condition.seconds)
        elif isinstance(condition, Rate):
            longest = max(longest, condition.window)
        else:
            longest = max(longest, timeout_of(condition) or 0.0)
    return longest
