"""The runs of rules and their actions, with an outcome each."""
