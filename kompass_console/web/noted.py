"""What people do that belongs on the robot's timeline, in words."""

from __future__ import annotations

from kompass_console.audit.line import AuditEntry


def note_of(deed: AuditEntry) -> str:
    """A few words for a line of the audit log; empty for what is told otherwise, or was refused.

    The monitor itself tells of edits, of missions and of who pressed STOP.
    """
    details = deed.details
    match deed.what, deed.outcome:
        case "send goal", "sent":
            place = details.get("place")
            return f"Sent the robot to {place or _point(deed)}"
        case "cancel goal", "asked":
            return "Cancelled the goal"
        case "locate robot", "told":
            return f"Set the robot's place to {_point(deed)}"
        case "release stop", "accepted":
            return "Released STOP"
        case "take control", "done":
            reason = details.get("reason")
            return f"Took control: {reason}" if reason else "Took control"
        case ("skip mission" | "confirm mission" | "resume mission") as what, "done":
            verb = {"skip": "Skipped a step of", "confirm": "Confirmed", "resume": "Resumed"}
            return f"{verb[what.partition(' ')[0]]} the mission"
        case _:
            return ""


def _point(deed: AuditEntry) -> str:
    return f"{float(deed.details['x']):.2f}, {float(deed.details['y']):.2f}"
