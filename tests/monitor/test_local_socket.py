"""The monitor answers who asks on its own machine, without ROS."""

import socket
import threading
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import pytest

from kompass.monitor.local_socket import (
    LocalAnswer,
    LocalMonitor,
    LocalSocket,
    Question,
    local_monitors,
)

DOMAIN = 7


def answer(service: str, request: Mapping[str, Any]) -> LocalAnswer:
    if service == "get_rules":
        return LocalAnswer(True, "", f"revision {request['revision']}")
    raise ValueError(f"{service} is not answered here")


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    # Longer than the path of a socket may be.
    made = tmp_path / ("long" * 25) / "robot"
    made.mkdir(parents=True)
    monkeypatch.setenv("KOMPASS_DATA_DIR", str(made.parent))
    monkeypatch.setenv("KOMPASS_ROBOT_NAME", "robot")
    return made


@pytest.fixture
def monitor() -> Iterator[LocalMonitor]:
    listening = LocalSocket(DOMAIN, "/hall/monitor", answer)
    (found,) = local_monitors(DOMAIN)
    yield found
    listening.close()
    assert local_monitors(DOMAIN) == []


def test_it_is_found_by_domain_and_says_its_name(monitor: LocalMonitor) -> None:
    assert monitor.name == "/hall/monitor"
    assert local_monitors(DOMAIN + 1) == []


def test_it_answers_one_question_after_another(monitor: LocalMonitor) -> None:
    asked = [Question(monitor, "get_rules", {"revision": number}) for number in range(5)]
    assert [each.answer(5.0).answer for each in asked] == [f"revision {n}" for n in range(5)]


def test_what_cannot_be_answered_is_told_as_a_sentence(monitor: LocalMonitor) -> None:
    refused = Question(monitor, "apply_rules", {}).answer(5.0)
    assert not refused.success
    assert "apply_rules is not answered here" in refused.message


def test_only_its_owner_may_ask(monitor: LocalMonitor) -> None:
    assert monitor.socket.stat().st_mode & 0o777 == 0o600


@pytest.mark.parametrize(
    "said", [b"", b"{", b"[]", b'{"service": "get_rules"}', b"\xff", b"x" * 99]
)
def test_rubbish_holds_nobody_up(monitor: LocalMonitor, said: bytes) -> None:
    with socket.socket(socket.AF_UNIX) as stranger:
        # By way of the folder, as the path itself is too long.
        stranger.connect(f"/proc/self/cwd/{monitor.socket.name}")
        stranger.sendall(said)
        stranger.shutdown(socket.SHUT_WR)
        assert b'"success": false' in stranger.recv(10_000)
    assert Question(monitor, "get_rules", {"revision": 3}).answer(5.0).answer == "revision 3"


@pytest.fixture(autouse=True)
def in_the_folder(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)


def test_who_says_nothing_holds_others_up_for_a_moment_only(monitor: LocalMonitor) -> None:
    with socket.socket(socket.AF_UNIX) as silent:
        silent.connect(f"/proc/self/cwd/{monitor.socket.name}")
        assert Question(monitor, "get_rules", {"revision": 3}).answer(10.0).success


def test_one_that_was_killed_is_not_found_and_replaced(folder: Path) -> None:
    left = folder / f"monitor.{DOMAIN}.monitor.sock"
    with socket.socket(socket.AF_UNIX) as dead:
        dead.bind(left.name)  # and nobody listens
    assert left.is_socket()
    assert local_monitors(DOMAIN) == []
    listening = LocalSocket(DOMAIN, "/monitor", answer)
    assert [each.name for each in local_monitors(DOMAIN)] == ["/monitor"]
    listening.close()


def test_a_second_one_does_not_take_the_first_ones_place(monitor: LocalMonitor) -> None:
    with pytest.raises(FileExistsError, match="another monitor listens"):
        LocalSocket(DOMAIN, "/hall/monitor", answer)
    assert Question(monitor, "get_rules", {"revision": 1}).answer(5.0).success


def test_closing_waits_for_the_answer_under_way() -> None:
    began, may_end = threading.Event(), threading.Event()

    def slowly(service: str, request: Mapping[str, Any]) -> LocalAnswer:
        began.set()
        may_end.wait(10.0)
        return LocalAnswer(True, "", "at last")

    listening = LocalSocket(DOMAIN, "/monitor", slowly)
    (found,) = local_monitors(DOMAIN)
    asked = Question(found, "get_rules", {})
    began.wait(10.0)
    closing = threading.Thread(target=listening.close)
    closing.start()
    may_end.set()
    assert asked.answer(10.0).answer == "at last"
    closing.join(10.0)
    assert not closing.is_alive()
