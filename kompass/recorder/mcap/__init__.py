"""MCAP files: written so that a kill loses little, read even where the end is missing."""
