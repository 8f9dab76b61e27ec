"""Actions under the older import name."""

from kompass.actions import *  # noqa: F403
