"""The audit log on disk: written in a chain, read, and checked. Knows nothing of the web."""
