"""A recipe of the benchmarks, run as a user runs one, on a ROS domain of its own."""

import os
import re
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

RECIPES = Path(__file__).parent / "recipes"
PATIENCE = 30.0  # s
DOMAIN = str(38 + os.getpid() % 60)


def prepare_environment() -> None:
    """Choose domain and middleware; comes before rclpy is imported."""
    os.environ["ROS_DOMAIN_ID"] = DOMAIN
    os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    from kompass.rclpy_ext.middleware import prepare_middleware

    prepare_middleware()


class Recipe:
    """A running recipe, its output, and the processes in it."""

    def __init__(self, name: str, **environment: str) -> None:
        self.began = time.monotonic()
        self._data = tempfile.TemporaryDirectory(prefix="kompass-benchmark-")
        # A file takes all that is said; a pipe that nobody empties would hold the stack up.
        self._log = Path(self._data.name) / "output"
        with self._log.open("w") as log:
            self.process = subprocess.Popen(
                [sys.executable, str(RECIPES / name)],
                stdout=log,
                stderr=log,
                start_new_session=True,
                env={**os.environ, "KOMPASS_DATA_DIR": self._data.name, **environment},
            )
        while "all components active" not in self.output:
            if self.process.poll() is not None or time.monotonic() - self.began > PATIENCE:
                raise RuntimeError(f"{name} does not start:\n{self.output}")
            time.sleep(0.005)
        self.whole = time.monotonic() - self.began

    @property
    def output(self) -> str:
        """All that it has said so far."""
        return self._log.read_text()

    @property
    def bringup(self) -> float:
        """What the launcher says that it took [s]."""
        found = re.search(r"all components active in ([\d.]+) s", self.output)
        assert found
        return float(found[1])

    @property
    def pids(self) -> dict[str, int]:
        """Process ids by the supervisor's names."""
        found = re.findall(r"(\w+) is process (\d+)", self.output)
        return {name: int(pid) for name, pid in found}

    def stop(self) -> float:
        """Ctrl-C; how long the end took [s]."""
        began = time.monotonic()
        os.killpg(self.process.pid, signal.SIGINT)
        self.process.wait(20)
        took = time.monotonic() - began
        self._data.cleanup()
        return took


@contextmanager
def running(name: str, **environment: str) -> Iterator[Recipe]:
    """A recipe for as long as the block lasts."""
    recipe = Recipe(name, **environment)
    try:
        yield recipe
    finally:
        recipe.stop()
