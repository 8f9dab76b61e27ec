"""Followers of what a detector finds in a camera's image."""
