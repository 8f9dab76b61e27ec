"""Why a rule fires, or why it does not."""

from kompass.rulebook.schema.journal import FiringRecord
from kompass.rulebook.schema.status import LeafReading, RuleStatus
from kompass.rules.schema.model import Model
from kompass.rules.schema.table import Rule


class GateView(Model):
    """One thing that keeps a rule from firing; ``left`` are seconds until it opens by itself."""

    kind: str
    text: str
    left: float | None = None


class ExplanationView(Model):
    """A rule now, or at a firing.

    Attributes
    ----------
    condition
        As text.
    firing
        The firing explained; None for now.
    rule
        As it was then: of the revision that fired.
    near_misses
        When it came close lately and did not fire, newest first.
    changed_since
        Whether the rule differs today from the one that fired.
    """

    rule_id: str
    time: float
    text: str
    condition: str
    rule: Rule
    revision: int
    status: RuleStatus | None = None
    leaves: tuple[LeafReading, ...] = ()
    clear_leaves: tuple[LeafReading, ...] = ()
    gates: tuple[GateView, ...] = ()
    firing: FiringRecord | None = None
    near_misses: tuple[FiringRecord, ...] = ()
    changed_since: bool = False
