"""A table made ready to run, its state, and the step from one to the next."""
