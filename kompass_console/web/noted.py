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
            if place:
                return f"Sent the robot to {place}"
            return f"Sent the robot to ({_point(deed)})"
        case "cancel goal", "asked":
            return "Cancelled the goal"
        case "locate robot", "told":
            return f"Set the robot's place to ({_point(deed)})"
        case "release stop", "accepted":
            return "Released STOP"
        case "take control", "done":
            reason = details.get("reason")
            return f"Took control: {reason}" if reason else "Took control"
        case "skip mission", "done":
            return "Skipped a step of the mission"
        case "confirm mission", "done":
            return "Confirmed the mission"
        case "resume mission", "done":
            return "Resumed the mission"
        case _:
            return ""


def _point(deed: AuditEntry) -> str:
    return f"{float(deed.details['x']):z.2f}, {float(deed.details['y']):z.2f}"
