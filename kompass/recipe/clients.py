"""What older recipes hand to ``launcher.enable_ui``: services and actions for its page."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class ServiceClientConfig:
    """A service that somebody may call.

    Attributes
    ----------
    timeout_secs, attempt_period_secs
        Seconds to wait for it, and between two tries.
    """

    srv_type: type
    name: str
    timeout_secs: float = 30.0
    attempt_period_secs: float = 1.0


@dataclass(frozen=True, kw_only=True)
class ActionClientConfig:
    """An action that somebody may send goals to.

    Attributes
    ----------
    timeout_secs, attempt_period_secs
        Seconds to wait for it, and between two tries.
    feedback_check_period, feedback_check_timeout
        Seconds between two looks at the feedback, and after which there is none.
    """

    action_type: type
    name: str
    timeout_secs: float = 30.0
    attempt_period_secs: float = 1.0
    feedback_check_period: float = 0.05
    feedback_check_timeout: float = 60.0
