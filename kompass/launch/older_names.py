"""What launchers of older recipes could be asked for, under its names."""

from __future__ import annotations

import os
import runpy
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from kompass.components.base.component import Component
from kompass.launch.companions import add_companion
from kompass.settings import notice_once
from kompass.supervisor.process import ProcessSpec, Report


class OlderNames:
    """Methods that other generations of the launcher have; each leads to what it is today."""

    def kompass(self, components: list[Component], *args: Any, **kwargs: Any) -> None:
        """Add components; see the launcher."""
        raise NotImplementedError

    def agents(self, components: list[Component], *args: Any, **kwargs: Any) -> None:
        """As :meth:`kompass`."""
        self.kompass(components, *args, **kwargs)

    def add_pkg(
        self,
        components: list[Component],
        package_name: str | None = None,
        executable_entry_point: str = "executable",
        events_actions: Mapping[Any, Any] | None = None,
        multiprocessing: bool = False,
        activate_all_components_on_start: bool = True,
        components_to_activate_on_start: list[Component] | None = None,
        ros_log_level: str | None = None,
        rclpy_log_level: str | None = None,
    ) -> None:
        """As :meth:`kompass`, with threads unless processes are asked for.

        ``package_name`` and ``executable_entry_point`` have no meaning here: a process is a fork,
        so any component can have one.
        """
        self.kompass(
            components,
            events_actions,
            multiprocessing,
            activate_all_components_on_start,
            components_to_activate_on_start,
            ros_log_level,
            rclpy_log_level,
        )

    def enable_ui(self, *_: Any, **__: Any) -> None:
        """Say where the page comes from today."""
        notice_once(
            "launcher.enable_ui(): the page comes with `kompass-console run <recipe>`, and shows "
            "all components without being told"
        )

    def setup_launch_description(self) -> None:
        """Nothing is to be set up before :meth:`bringup`."""

    def add_py_executable(self, path_to_executable: str, name: str = "python3") -> None:
        """Run a Python program beside the components, started again when it dies.

        Raises
        ------
        FileNotFoundError
            When there is no such program.
        """
        path = Path(path_to_executable)
        if not path.is_file():
            raise FileNotFoundError(f"add_py_executable: there is no program {path}")

        def main(report: Report) -> None:
            report(f"active {path.stem}")
            sys.argv = [str(path)]
            runpy.run_path(str(path), run_name="__main__")

        add_companion(ProcessSpec(path.stem, main))

    def add_method(
        self,
        method: Callable[..., Any],
        args: Sequence[Any] | None = None,
        kwargs: Mapping[str, Any] | None = None,
    ) -> None:
        """Run a function once beside the components, in a process of its own."""
        if not callable(method):
            raise TypeError(f"add_method: method = {method!r} is not a function")
        name = getattr(method, "__name__", "method")

        def main(report: Report) -> None:
            report(f"active {name}")
            method(*(args or ()), **(kwargs or {}))

        add_companion(ProcessSpec(name, main, restart=False))


def processes_wanted(stated: bool | None) -> bool:
    """Whether components get a process each: as stated, unless the environment says otherwise.

    ``KOMPASS_MULTI_PROCESSING=0`` puts all into one process, ``1`` each into its own, whatever a
    recipe says: to debug a stack, or to save memory.

    Raises
    ------
    ValueError
        When the variable holds something else.
    """
    override = os.environ.get("KOMPASS_MULTI_PROCESSING", "")
    if override not in ("", "0", "1"):
        raise ValueError(f"KOMPASS_MULTI_PROCESSING={override!r} is neither 0 nor 1")
    return override == "1" if override else stated is not False
