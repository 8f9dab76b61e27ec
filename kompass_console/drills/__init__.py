"""Drills that people ask for on the page, where the console runs."""
