"""What people change of what the robot keeps, as happenings."""

from __future__ import annotations

from kompass.timeline.happening import Happened

_DONE = {"save": "saved", "edit": "changed", "delete": "deleted", "restore": "restored"}


def edited(what: str, kind: str, name: str, who: str, now: float) -> Happened:
    """Somebody saved, changed, deleted or restored something.

    Parameters
    ----------
    what, name
        Of what kind it is, for people, and its name.
    kind
        Of the change: save, edit, delete or restore.
    now
        Seconds since the epoch.
    """
    return Happened(now, "edit", f"{what} {_DONE[kind]}: {name}", who=who)
