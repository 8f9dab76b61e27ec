"""The last checks before the wheels: limits and the stop zone."""
