"""The data in which everybody speaks of rules: pydantic models, and nothing else."""
