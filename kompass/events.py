"""The events under an older import name."""

from kompass.event import *  # noqa: F403
