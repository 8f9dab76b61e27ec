"""Processes that run beside a recipe's components: the embedded robot, the console, programs.

The command line adds them before it runs the recipe, whose own ``launcher.bringup()`` then starts
them too. So the recipe stays as it is, and this package knows nothing of either.
"""

import runpy
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from kompass.components.base.component import Component
from kompass.monitor.execution.component_handles import make_handles
from kompass.monitor.recipe_call import RecipeCall
from kompass.supervisor.process import ProcessSpec, Report

_companions: list[ProcessSpec] = []


def add_companion(spec: ProcessSpec) -> None:
    """Run a process beside the components of the next bring-up."""
    _companions.append(spec)


def companions() -> list[ProcessSpec]:
    """What was added, in order."""
    return list(_companions)


def program_process(path: Path) -> ProcessSpec:
    """A process that runs a Python program, and is started again when it dies.

    Raises
    ------
    FileNotFoundError
        When there is no such program.
    """
    if not path.is_file():
        raise FileNotFoundError(f"add_py_executable: there is no program {path}")

    def main(report: Report) -> None:
        report(f"active {path.stem}")
        sys.argv = [str(path)]
        runpy.run_path(str(path), run_name="__main__")

    return ProcessSpec(path.stem, main)


def function_process(
    function: Callable[..., Any],
    args: Sequence[Any],
    kwargs: Mapping[str, Any],
    components: Sequence[Component] = (),
) -> ProcessSpec:
    """A process that calls a function once.

    Parameters
    ----------
    components
        Which live elsewhere: the function is told so when it asks something of them.

    Raises
    ------
    TypeError
        When it is not a function.
    """
    if not callable(function):
        raise TypeError(f"add_method: method = {function!r} is not a function")
    name = getattr(function, "__name__", "method")

    def main(report: Report) -> None:
        report(f"active {name}")
        make_handles(components, None)
        RecipeCall(lambda: function(*args, **kwargs)).run()

    return ProcessSpec(name, main, restart=False)
