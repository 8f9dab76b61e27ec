"""The supervisor starts again what dies, gives up on what cannot live, and ends all in order."""

import json
import os
import signal
import subprocess
import sys
import textwrap
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.support.processes import wait_until

# A supervisor in an interpreter of its own: it must fork from one thread and owns its signals.
PROGRAM = """
    import logging, os, sys, time, json
    from kompass.launch.process import ProcessSpec
    from kompass.launch.supervisor import StartupError, Supervisor

    logging.basicConfig(stream=sys.stdout, format="%(message)s", level=logging.INFO)
    said = open({said!r}, "a", buffering=1)

    def waits(report):
        report("active")
        import signal

        def end(*_):
            said.write(f"{{os.getpid()}} ended\\n")
            os._exit(0)

        signal.signal(signal.SIGTERM, end)
        while True:
            time.sleep(60)

    def stubborn(report):
        import signal
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        report("active")
        while True:
            time.sleep(60)

    def dies(report):
        report("active")
        raise ValueError("no\\nluck")

    def never(report):
        raise ValueError("cannot start")

    def listens(report):
        report("active")
        for line in os.fdopen({name}.inbox):
            said.write(line)

    {specs}
    try:
        Supervisor(specs, announced=["a"]).run()
    except StartupError as error:
        print("startup:", error)
        sys.exit(1)
"""


class Program:
    def __init__(self, folder: Path, specs: str, name: str = "None") -> None:
        self.said = folder / "said"
        self.said.touch()
        source = textwrap.dedent(PROGRAM).format(said=str(self.said), specs=specs, name=name)
        self.output = folder / "output"
        self._file = self.output.open("w")
        self.process = subprocess.Popen(
            [sys.executable, "-c", source], stdout=self._file, stderr=subprocess.STDOUT
        )

    def text(self) -> str:
        return self.output.read_text()

    def wait_for(self, text: str, timeout: float = 15.0) -> None:
        wait_until(lambda: text in self.text(), timeout, f"{text!r} in {self.text()}")

    def close(self) -> int:
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
        code = self.process.wait(10)
        self._file.close()
        return code


@pytest.fixture
def programs() -> Iterator[list[Program]]:
    made: list[Program] = []
    yield made
    for program in made:
        program.close()


def test_what_is_killed_is_started_again(tmp_path: Path, programs: list[Program]) -> None:
    program = Program(tmp_path, "specs = [ProcessSpec('a', waits)]")
    programs.append(program)
    program.wait_for("a is up")
    first = int(program.text().split("a is process ")[1].split()[0])
    os.kill(first, signal.SIGKILL)
    program.wait_for("a killed by SIGKILL")
    wait_until(lambda: program.text().count("a is up") == 2, 5, "a second life")


def test_what_dies_again_and_again_is_given_up(tmp_path: Path, programs: list[Program]) -> None:
    program = Program(tmp_path, "specs = [ProcessSpec('a', dies), ProcessSpec('b', waits)]")
    programs.append(program)
    program.wait_for("a: ValueError: no luck")
    program.wait_for("given up", 20)
    assert program.process.poll() is None


def test_what_cannot_start_at_all_ends_the_stack(tmp_path: Path, programs: list[Program]) -> None:
    program = Program(tmp_path, "specs = [ProcessSpec('b', waits), ProcessSpec('a', never)]")
    programs.append(program)
    assert program.process.wait(10) == 1
    assert "a: ValueError: cannot start" in program.text()
    assert "startup: a could not start" in program.text()
    assert "ended" in program.said.read_text()


def test_what_halts_the_robot_ends_before_all_others(
    tmp_path: Path, programs: list[Program]
) -> None:
    program = Program(
        tmp_path,
        "specs = [ProcessSpec('b', waits), ProcessSpec('a', waits, stops_robot=True)]",
    )
    programs.append(program)
    program.wait_for("a is up")
    program.wait_for("b is up")
    gate = program.text().split("a is process ")[1].split()[0]
    assert program.close() == 0
    assert program.said.read_text().splitlines()[0] == f"{gate} ended"


def test_what_does_not_end_is_killed(tmp_path: Path, programs: list[Program]) -> None:
    program = Program(tmp_path, "specs = [ProcessSpec('a', stubborn)]")
    programs.append(program)
    program.wait_for("a is up")
    pid = program.text().split("a is process ")[1].split()[0]
    assert program.close() == 0
    assert "a did not end" in program.text()
    assert not Path(f"/proc/{pid}").exists()


def test_who_listens_is_told_how_the_others_are_doing(
    tmp_path: Path, programs: list[Program]
) -> None:
    program = Program(
        tmp_path,
        "ear = ProcessSpec('m', listens, listens=True); "
        "specs = [ProcessSpec('a', waits, names=['node_a']), ear]",
        name="ear",
    )
    programs.append(program)
    program.wait_for("a is up")
    pid = int(program.text().split("a is process ")[1].split()[0])
    os.kill(pid, signal.SIGKILL)

    def told() -> list[dict[str, object]]:
        lines = program.said.read_text().splitlines()
        return [json.loads(line) for line in lines if line.startswith("{")]

    wait_until(
        lambda: (
            [t["state"] for t in told() if t["name"] == "a"][-3:] == ["dead", "starting", "active"]
        ),
        10,
        "the whole story",
    )
    dead = next(t for t in told() if t["state"] == "dead")
    assert dead["nodes"] == ["node_a"]
    assert dead["reason"] == "the process was killed by SIGKILL"
