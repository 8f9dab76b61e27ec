"""The motion server: tests of the base, recorded and made into numbers."""
