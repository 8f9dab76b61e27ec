"""A whole stack as a user starts it: the command line, in a process group of its own."""

import os
import re
import signal
import subprocess
import sys
import tempfile
import threading
from collections.abc import Sequence
from pathlib import Path

from tests.support.domains import give_back, next_domain
from tests.support.keys import give_key
from tests.support.patience import patient
from tests.support.processes import end_with_parent, wait_until

TOKEN = "operator-token-for-tests"
RECIPE = Path(__file__).parents[2] / "recipes" / "01_point_navigation.py"


class Stack:
    """``kompass-console ARGUMENTS``, with its output at hand and a data folder of its own.

    Parameters
    ----------
    through
        A command that starts it, with its arguments.
    """

    def __init__(
        self,
        *arguments: str,
        domain: int | None = None,
        through: Sequence[str] = (),
        **environment: str,
    ) -> None:
        give_key()
        self._own_domain = domain is None
        self.domain = next_domain(stack=True) if domain is None else domain
        self._data = tempfile.TemporaryDirectory(prefix="kompass-data-")
        self.data_dir = Path(environment.get("KOMPASS_DATA_DIR", self._data.name))
        command = [*through, str(Path(sys.executable).with_name("kompass-console")), *arguments]
        self.process = subprocess.Popen(
            command,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
            preexec_fn=end_with_parent,
            env={
                **os.environ,
                "PYTHONUNBUFFERED": "1",
                "KOMPASS_CONSOLE_TOKEN": TOKEN,
                "KOMPASS_DATA_DIR": str(self.data_dir),
                **environment,
                "ROS_DOMAIN_ID": str(self.domain),
            },
        )
        self.output = ""
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    @classmethod
    def simulated(cls, *arguments: str, recipe: Path = RECIPE, **environment: str) -> "Stack":
        """A recipe with the embedded robot, ready to drive."""
        return cls.active(recipe, "--sim", *arguments, **environment)

    @classmethod
    def active(
        cls, recipe: Path, *arguments: str, through: Sequence[str] = (), **environment: str
    ) -> "Stack":
        """A recipe, once all of its components are active."""
        command = ("run", str(recipe), "--no-browser", "--port", "0", *arguments)
        stack = cls(*command, domain=None, through=through, **environment)
        try:
            stack.wait_for_line("all components active", 20)
        except AssertionError:
            stack.close()
            raise
        return stack

    def _read(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self.output += line

    def wait_for_line(self, text: str, timeout: float) -> None:
        """Wait until the output holds ``text``."""
        wait_until(
            lambda: text in self.output or self.process.poll() is not None,
            timeout,
            f"'{text}' in:\n{self.output}",
        )
        assert text in self.output, f"ended with {self.process.returncode}:\n{self.output}"

    @property
    def url(self) -> str:
        """Address of the console, without the token."""
        self.wait_for_line("Console:", 10)
        found = re.search(r"Console:\s+(http://[^/]+)/", self.output)
        assert found
        return found[1]

    def pid_of(self, name: str) -> int:
        """Process id of a child, by the name that the supervisor gave it."""
        found = re.findall(rf"{name} is process (\d+)", self.output)
        assert found, self.output
        return int(found[-1])

    def interrupt(self) -> None:
        """Ctrl-C: the signal reaches the whole group, as a terminal sends it."""
        os.killpg(self.process.pid, signal.SIGINT)

    def close(self) -> int:
        """Ctrl-C and wait; the exit code."""
        if self.process.poll() is None:
            self.interrupt()
        return self.wait(10.0)

    def wait(self, timeout: float = 20.0) -> int:
        """Wait for it to end by itself; the exit code."""
        code = self.process.wait(patient(timeout))
        self._reader.join(2.0)
        if self.process.stdout is not None:
            self.process.stdout.close()
        self._data.cleanup()
        if self._own_domain:
            give_back(self.domain)
        return code
