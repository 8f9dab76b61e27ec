"""Attacks on what the documents promise, by whoever might make them."""
