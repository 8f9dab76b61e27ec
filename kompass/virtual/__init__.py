"""A bus without DDS: nodes in one thread, in a time of their own, the same for the same seed.

What it honours of the real one, and what it does not, is told in docs/design.md.
"""
