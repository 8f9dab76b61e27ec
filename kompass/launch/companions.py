"""Processes that run beside a recipe's components: the embedded robot, the console.

The command line adds them before it runs the recipe, whose own ``launcher.bringup()`` then starts
them too. So the recipe stays as it is, and this package knows nothing of either.
"""

from kompass.supervisor.process import ProcessSpec

_companions: list[ProcessSpec] = []


def add_companion(spec: ProcessSpec) -> None:
    """Run a process beside the components of the next bring-up."""
    _companions.append(spec)


def companions() -> list[ProcessSpec]:
    """What was added, in order."""
    return list(_companions)
