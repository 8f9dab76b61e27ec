"""The controller, its settings, and where it sees obstacles."""
