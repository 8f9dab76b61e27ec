"""Events under the older import name."""

from kompass.event import *  # noqa: F403
