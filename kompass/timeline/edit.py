"""What people change of what the robot keeps, as happenings."""

from __future__ import annotations

from kompass.timeline.happening import Happened

_TITLES = {
    "save": "{what} saved: {name}",
    "edit": "{what} changed: {name}",
    "delete": "{what} deleted: {name}",
    "restore": "{what} restored: {name}",
}


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
    title = _TITLES[kind].format(what=what, name=name)
    return Happened(now, "edit", title, who=who)
