"""Tests of the benchmark of navigation."""
