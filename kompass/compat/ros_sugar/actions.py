"""Actions under the older import name."""

from kompass.actions import *  # noqa: F403
from kompass.actions import __getattr__  # noqa: F401
