"""The supervisor starts again what dies, gives up on what cannot live, and ends all in order."""

import json
import os
import signal
import socket
import subprocess
import sys
import textwrap
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.support.patience import patient
from tests.support.processes import end_with_parent, wait_until

pytestmark = pytest.mark.ros

# A supervisor in an interpreter of its own: it must fork from one thread and owns its signals.
PROGRAM = """
    import logging, os, sys, time, json
    from kompass.supervisor.process import ProcessSpec
    from kompass.supervisor.oversight import StartupError
    from kompass.supervisor.supervisor import Supervisor

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

    def holds_a_port(report):
        import signal, socket
        signal.signal(signal.SIGTERM, lambda *_: os._exit(0))
        taken = socket.create_server(("127.0.0.1", 0))
        said.write(f"port {{taken.getsockname()[1]}}\\n")
        report("active")
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

    def crashes(report):
        report("active")
        import ctypes
        ctypes.string_at(0)

    def beats(report):
        import signal
        from kompass.supervisor.heartbeat import send_heartbeat
        signal.signal(signal.SIGTERM, lambda *_: os._exit(0))
        hang = {hang!r}
        send_heartbeat("node_a")
        report("active")
        began = time.monotonic()
        while True:
            if hang and time.monotonic() - began > 0.3:
                if hang == "sleeps":
                    hang = ""
                    time.sleep(1.5)
                elif hang == "holds the interpreter":
                    import ctypes
                    ctypes.PyDLL(None).usleep(60_000_000)
                elif hang == "computes for ever":
                    while True:
                        sum(range(1000))
                elif hang == "never returns":
                    while True:
                        time.sleep(0.01)
            send_heartbeat("node_a")
            time.sleep(0.05)

    def beats_once(report):
        # Its later lives do not get so far.
        mark = said.name + "_lived"
        if os.path.exists(mark):
            time.sleep(600)
        open(mark, "w").close()
        beats(report)

    def never(report):
        raise ValueError("cannot start")

    def listens(report):
        report("active")
        for line in os.fdopen({name}.inbox):
            said.write(line)
            if '"stuck"' in line and {hang!r} == "never returns":
                report("restart node_a")

    def listens_to_the_end(report):
        import signal
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        listens(report)

    {specs}
    try:
        Supervisor(specs, announced=["a"], **{options}).run()
    except StartupError as error:
        print("startup:", error)
        sys.exit(1)
"""


def begin_afresh() -> None:
    """End with the test, and obey SIGHUP though the tests themselves may run under nohup."""
    end_with_parent()
    signal.signal(signal.SIGHUP, signal.SIG_DFL)


class Program:
    def __init__(
        self, folder: Path, specs: str, name: str = "None", hang: str = "", options: str = "{}"
    ) -> None:
        self.said = folder / "said"
        self.said.touch()
        source = textwrap.dedent(PROGRAM).format(
            said=str(self.said), specs=specs, name=name, hang=hang, options=options
        )
        self.output = folder / "output"
        self._file = self.output.open("w")
        self.process = subprocess.Popen(
            [sys.executable, "-c", source],
            stdout=self._file,
            stderr=subprocess.STDOUT,
            preexec_fn=begin_afresh,
        )

    def text(self) -> str:
        return self.output.read_text()

    def wait_for(self, text: str, timeout: float = 15.0) -> None:
        wait_until(lambda: text in self.text(), timeout, f"{text!r} in {self.text()}")

    def told(self, name: str) -> list[str]:
        """States of a process, in the order in which they were told."""
        lines = [json.loads(line) for line in self.said.read_text().splitlines() if line[0] == "{"]
        return [line["state"] for line in lines if line["name"] == name]

    def pid_of(self, name: str) -> int:
        return int(self.text().split(f"{name} is process ")[-1].split()[0])

    def close(self) -> int:
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
        code = self.process.wait(patient(10))
        self._file.close()
        return code


def alive(pid: int) -> bool:
    """Whether a process runs; one that only waits to be reaped does not.

    Its first thread is a zombie before the others are gone, and what they hold (a port) with them.
    """
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
        threads = len(list(Path(f"/proc/{pid}/task").iterdir()))
    except (FileNotFoundError, ProcessLookupError):
        return False
    return state != "Z" or threads > 1


@pytest.fixture
def programs() -> Iterator[list[Program]]:
    made: list[Program] = []
    yield made
    for program in made:
        program.close()


def test_its_end_does_not_look_like_a_crash(tmp_path: Path, programs: list[Program]) -> None:
    program = Program(tmp_path, "from ompl import base; specs = [ProcessSpec('a', waits)]")
    programs.append(program)
    program.wait_for("a is up")
    assert program.close() == 0
    assert "leaked" not in program.text()


def test_what_is_killed_is_started_again(tmp_path: Path, programs: list[Program]) -> None:
    program = Program(tmp_path, "specs = [ProcessSpec('a', waits)]")
    programs.append(program)
    program.wait_for("a is up")
    first = int(program.text().split("a is process ")[1].split()[0])
    os.kill(first, signal.SIGKILL)
    program.wait_for("a killed by SIGKILL")
    wait_until(lambda: program.text().count("a is up") == 2, 5, "a second life")


def sockets(pid: int) -> set[str]:
    links = [link.readlink() for link in Path(f"/proc/{pid}/fd").iterdir() if link.is_symlink()]
    return {link.name for link in links if link.name.startswith("socket:")}


def test_a_channel_is_open_at_its_ends_and_nowhere_else_over_their_deaths(
    tmp_path: Path, programs: list[Program]
) -> None:
    program = Program(
        tmp_path,
        "import socket; one, other = (end.detach() for end in socket.socketpair()); "
        "specs = [ProcessSpec('a', waits, channels={'x': one}), ProcessSpec('c', waits), "
        "ProcessSpec('b', waits, channels={'x': other}), ProcessSpec('d', waits)]",
    )
    programs.append(program)

    def ends() -> dict[str, set[str]]:
        for name in ("a", "b", "c", "d", "guard"):
            program.wait_for(f"{name} is up")
        return {name: sockets(program.pid_of(name)) for name in ("a", "b", "c", "d", "guard")}

    first = ends()
    assert len(first["a"]) == len(first["b"]) == 1
    assert first["a"] | first["b"] == sockets(program.process.pid)
    assert first["a"] != first["b"]
    assert not first["c"] | first["d"] | first["guard"]
    killed = ("a", "c", "guard")
    for name in killed:
        os.kill(program.pid_of(name), signal.SIGKILL)
    wait_until(lambda: all(program.text().count(f"{x} is up") == 2 for x in killed), 10, "others")
    assert ends() == first


def test_a_crash_in_native_code_says_where_it_was(tmp_path: Path, programs: list[Program]) -> None:
    program = Program(tmp_path, "specs = [ProcessSpec('a', crashes, restart=False)]")
    programs.append(program)
    program.wait_for("a killed by SIGSEGV")
    assert "Fatal Python error: Segmentation fault" in program.text()
    assert "in crashes" in program.text()


def test_what_dies_again_and_again_is_given_up(tmp_path: Path, programs: list[Program]) -> None:
    program = Program(
        tmp_path,
        "from kompass.supervisor.restarts import Restarts; "
        "specs = [ProcessSpec('a', dies), ProcessSpec('b', waits)]",
        options="dict(restarts=Restarts(2))",
    )
    programs.append(program)
    program.wait_for("a: ValueError: no luck")
    program.wait_for("a died 3 times in a row: given up")
    assert program.process.poll() is None


def test_what_cannot_start_at_all_ends_the_stack(tmp_path: Path, programs: list[Program]) -> None:
    program = Program(tmp_path, "specs = [ProcessSpec('b', waits), ProcessSpec('a', never)]")
    programs.append(program)
    assert program.process.wait(patient(10)) == 1
    assert "a: ValueError: cannot start" in program.text()
    assert "startup: a could not start" in program.text()
    assert not Path(f"/proc/{program.pid_of('b')}").exists()


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


def port_of(program: Program) -> int:
    wait_until(lambda: "port " in program.said.read_text(), 10, "a port that is held")
    return int(program.said.read_text().split("port ")[1].split()[0])


@pytest.mark.parametrize("stopped", ["a", "b", "guard"])
def test_nothing_outlives_a_killed_supervisor_though_a_signal_holds_it(
    tmp_path: Path, programs: list[Program], stopped: str
) -> None:
    program = Program(tmp_path, "specs = [ProcessSpec('a', holds_a_port), ProcessSpec('b', waits)]")
    programs.append(program)
    for name in ("guard", "a", "b"):
        program.wait_for(f"{name} is up")
    port = port_of(program)
    pids = {name: program.pid_of(name) for name in ("guard", "a", "b")}
    os.kill(pids[stopped], signal.SIGSTOP)
    os.kill(program.process.pid, signal.SIGKILL)
    wait_until(lambda: not [pid for pid in pids.values() if alive(pid)], 3.0, "the end of all")
    with socket.create_server(("127.0.0.1", port)):
        pass  # free for the next one


def test_nothing_outlives_a_killed_supervisor_though_it_does_not_obey(
    tmp_path: Path, programs: list[Program]
) -> None:
    program = Program(tmp_path, "specs = [ProcessSpec('a', stubborn)]")
    programs.append(program)
    program.wait_for("a is up")
    program.wait_for("guard is up")
    # Also one that came to life after the guard did, and a guard in its second life.
    os.kill(program.pid_of("a"), signal.SIGKILL)
    wait_until(lambda: program.text().count("a is up") == 2, 5, "a second life")
    os.kill(program.pid_of("guard"), signal.SIGKILL)
    wait_until(lambda: program.text().count("guard is up") == 2, 5, "another guard")
    pid = program.pid_of("a")
    os.kill(program.process.pid, signal.SIGKILL)
    wait_until(lambda: not alive(pid), 3.0, "its end")


def test_a_guard_that_hears_of_a_process_after_the_supervisors_death_ends_it_all_the_same(
    tmp_path: Path, programs: list[Program]
) -> None:
    program = Program(tmp_path, "specs = [ProcessSpec('a', stubborn)]")
    programs.append(program)
    program.wait_for("a is up")
    program.wait_for("guard is up")
    os.kill(program.pid_of("guard"), signal.SIGSTOP)  # until its supervisor dies
    os.kill(program.pid_of("a"), signal.SIGKILL)
    wait_until(lambda: program.text().count("a is up") == 2, 5, "a second life")
    pid = program.pid_of("a")
    os.kill(program.process.pid, signal.SIGKILL)
    wait_until(lambda: not alive(pid), 5.0, "its end")


def test_a_terminal_that_is_closed_ends_all_in_their_order(
    tmp_path: Path, programs: list[Program]
) -> None:
    program = Program(
        tmp_path,
        "specs = [ProcessSpec('b', waits), ProcessSpec('a', waits, stops_robot=True)]",
    )
    programs.append(program)
    program.wait_for("a is up")
    program.wait_for("b is up")
    gate = program.pid_of("a")
    # As the kernel sends it: to everybody at once.
    for pid in (program.pid_of("b"), gate, program.process.pid):
        os.kill(pid, signal.SIGHUP)
    assert program.process.wait(patient(10)) == 0
    assert program.said.read_text().splitlines()[0] == f"{gate} ended"


def test_who_is_still_there_at_the_end_hears_of_a_gate_that_had_to_be_killed(
    tmp_path: Path, programs: list[Program]
) -> None:
    program = Program(
        tmp_path,
        "ear = ProcessSpec('m', listens_to_the_end, listens=True); "
        "specs = [ProcessSpec('a', stubborn, stops_robot=True), ear]",
        name="ear",
    )
    programs.append(program)
    program.wait_for("a is up")
    program.wait_for("m is up")
    assert program.close() == 0
    assert program.told("a")[-1] == "dead"


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


EAR = "ear = ProcessSpec('m', listens, listens=True); "
LISTENED = EAR + "specs = [ProcessSpec('a', beats, names=['node_a']), ear]"
LIMITED = (
    "dict(limits=__import__('kompass.supervisor.liveness', fromlist=['x']).LivenessLimits({}))"
)


def listened(folder: Path, programs: list[Program], hang: str = "", limits: str = "") -> Program:
    options = LIMITED.format(limits)
    program = Program(folder, LISTENED, name="ear", hang=hang, options=options)
    programs.append(program)
    wait_until(lambda: "active" in program.told("a"), 10, "a living process")
    return program


def test_a_stopped_process_is_stuck_within_a_second_and_well_again_when_it_goes_on(
    tmp_path: Path, programs: list[Program]
) -> None:
    program = listened(tmp_path, programs)
    pid = program.pid_of("a")
    os.kill(pid, signal.SIGSTOP)
    wait_until(lambda: program.told("a")[-1] == "stuck", 1.0, "word of the stopped process")
    os.kill(pid, signal.SIGCONT)
    wait_until(lambda: program.told("a")[-1] == "active", 2.0, "word of its recovery")
    assert program.pid_of("a") == pid
    assert "dead" not in program.told("a")


def test_a_glance_of_a_debugger_is_no_failure(tmp_path: Path, programs: list[Program]) -> None:
    program = listened(tmp_path, programs, limits="stopped=1.0")
    os.kill(program.pid_of("a"), signal.SIGSTOP)
    wait_until(lambda: program.told("a")[-1] == "busy", 1.0, "word of it")
    said = [line for line in program.said.read_text().splitlines() if '"name": "a"' in line]
    assert json.loads(said[-1])["stopped"] is True
    os.kill(program.pid_of("a"), signal.SIGCONT)
    wait_until(lambda: program.told("a")[-1] == "active", 2.0, "word of its recovery")
    assert "stuck" not in program.told("a")


def test_a_process_that_stays_stuck_is_killed_and_started_again(
    tmp_path: Path, programs: list[Program]
) -> None:
    program = listened(tmp_path, programs, limits="killed=0.5")
    first = program.pid_of("a")
    os.kill(first, signal.SIGSTOP)
    wait_until(lambda: program.told("a")[-1] == "active" and "dead" in program.told("a"), 6, "life")
    assert program.pid_of("a") != first
    assert "a is killed: it was stuck" in program.text()


def test_one_that_a_signal_holds_while_it_starts_again_is_told_of_and_killed(
    tmp_path: Path, programs: list[Program]
) -> None:
    specs = LISTENED.replace("beats", "beats_once")
    program = Program(tmp_path, specs, name="ear", options=LIMITED.format("killed=1.5"))
    programs.append(program)
    wait_until(lambda: "active" in program.told("a"), 10, "a living process")
    os.kill(program.pid_of("a"), signal.SIGKILL)
    wait_until(lambda: program.told("a")[-2:] == ["dead", "starting"], 5, "a second life")
    second = program.pid_of("a")
    os.kill(second, signal.SIGSTOP)
    wait_until(lambda: program.told("a")[-1] == "stuck", 5, "word of it")
    os.kill(second, signal.SIGCONT)
    wait_until(lambda: program.told("a")[-1] == "starting", 5, "word that it goes on")
    os.kill(second, signal.SIGSTOP)
    wait_until(lambda: program.told("a")[-3:] == ["stuck", "dead", "starting"], 10, "a third life")
    assert "a is killed: it was held by a signal" in program.text()


def test_a_busy_executor_is_shown_and_left_alone(tmp_path: Path, programs: list[Program]) -> None:
    program = listened(tmp_path, programs, "sleeps")
    wait_until(lambda: program.told("a")[-1:] == ["busy"], 3, "word of the busy process")
    wait_until(lambda: program.told("a")[-1:] == ["active"], 5, "word of its recovery")
    assert program.told("a") == ["starting", "active", "busy", "active"]


def test_a_process_frozen_in_foreign_code_is_stuck(tmp_path: Path, programs: list[Program]) -> None:
    program = listened(tmp_path, programs, "holds the interpreter")
    began = time.monotonic()
    wait_until(lambda: "stuck" in program.told("a"), 5, "word of the frozen process")
    assert time.monotonic() - began < patient(2.0)


def test_an_executor_that_never_comes_round_is_stuck_in_the_end(
    tmp_path: Path, programs: list[Program]
) -> None:
    program = listened(tmp_path, programs, "computes for ever", "stuck=1.5, hung=1.5, killed=0.3")
    wait_until(lambda: program.told("a").count("active") == 2, 10, "a second life")
    assert program.told("a")[1:5] == ["active", "busy", "stuck", "dead"]


def test_who_allows_itself_longer_steps_is_not_stuck(
    tmp_path: Path, programs: list[Program]
) -> None:
    program = Program(
        tmp_path,
        EAR + "specs = [ProcessSpec('a', beats, names=['node_a'], allowed={'node_a': 60.0}), ear]",
        name="ear",
        hang="sleeps",
        options=LIMITED.format("stuck=0.7"),
    )
    programs.append(program)
    wait_until(lambda: program.told("a")[-2:] == ["busy", "active"], 10, "a long step")
    assert "stuck" not in program.told("a")


def test_nodes_that_share_a_process_are_told_of_one_by_one(
    tmp_path: Path, programs: list[Program]
) -> None:
    program = Program(
        tmp_path,
        EAR + "specs = [ProcessSpec('components', beats, names=['node_a', 'node_b']), ear]",
        name="ear",
        hang="never returns",
        options=LIMITED.format("stuck=60, hung=60"),
    )
    programs.append(program)
    wait_until(lambda: "busy" in program.told("node_a"), 10, "word of the busy node")
    assert program.told("components") == []


def test_a_stuck_process_is_started_anew_at_once_when_somebody_asks(
    tmp_path: Path, programs: list[Program]
) -> None:
    program = listened(tmp_path, programs, "never returns", "stuck=0.8, killed=None")
    wait_until(lambda: program.told("a").count("active") == 2, 10, "a second life")
    assert "a is killed: a restart was asked for" in program.text()


def test_who_is_not_active_in_time_ends_the_stack(tmp_path: Path, programs: list[Program]) -> None:
    program = Program(
        tmp_path,
        "specs = [ProcessSpec('a', lambda report: time.sleep(60))]",
        options="dict(activation_timeout=0.5)",
    )
    programs.append(program)
    assert program.process.wait(patient(10)) == 1
    assert "a did not become active within 0.5 s" in program.text()
