"""The global planner, and the life of a goal."""
