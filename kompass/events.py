"""The events under an older import name."""

from kompass.event import *  # noqa: F403
from kompass.event import __getattr__  # noqa: F401
