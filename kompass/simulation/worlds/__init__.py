"""The worlds that ship with Kompass, one per file."""
