"""Alarms that rules raised and nobody has cleared yet."""

from pydantic import Field

from kompass.rules.schema.model import Model


class Alarm(Model):
    """One alarm, shown to the operators until it is cleared.

    Attributes
    ----------
    name
        What the actions that raise and clear it call it.
    since
        Seconds since the epoch at which it was first raised; ``count`` how often since then.
    until_seen
        Whether it ends when somebody acknowledges it: no rule would clear it.
    acknowledged_by
        Who has seen it; empty for nobody.
    shelved_until, shelved_by
        Until when (s since the epoch) it is put away, and by whom; 0 where it is not.
    """

    name: str
    text: str = ""
    rule_id: str = ""
    severity: str = "warning"
    since: float
    count: int = Field(default=1, ge=1)
    until_seen: bool = False
    acknowledged_by: str = ""
    shelved_until: float = Field(default=0.0, ge=0.0)
    shelved_by: str = ""
