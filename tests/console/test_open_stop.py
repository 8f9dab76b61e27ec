"""STOP for those who are not logged in: what it does, what it never does, and what it costs."""

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from kompass_console.audit.read import lines_after
from kompass_console.schema.roles import Role
from tests.console.conftest import Served, running_stack, serving
from tests.support.processes import wait_until

pytestmark = pytest.mark.ros

PATH = "/api/stop/without-login"


def seen(console: Served) -> object:
    """What whoever is not logged in is told of STOP."""
    with console.client() as client:
        return client.get(PATH).json()


def test_who_is_locked_out_stops_the_robot_and_somebody_who_is_not_releases_it(
    console: Served,
) -> None:
    with running_stack():
        wait_until(lambda: seen(console) == free(), 30.0, "the drive manager is heard")
        with console.client() as client:
            assert client.post(PATH).json() == {"accepted": True, "message": "stopped"}
            stands = {"offered": True, "seen": {"stopped": True, "standstill": True}}
            wait_until(lambda: seen(console) == stands, 5.0, "that it stands")
            for path in ("/api/stop/release", PATH + "/release"):
                assert client.post(path).status_code in (401, 404, 405)
            assert seen(console) == stands
        with console.client(Role.OPERATOR, user="ava") as client:
            assert client.post("/api/stop/release").json()["accepted"]
        wait_until(lambda: seen(console) == free(), 5.0, "that it is free again")
    [line] = [line for line in console.audited() if line["what"] == "stop without log-in"]
    assert (line["who"], line["role"], line["from"]) == ("?", "none", "127.0.0.1")
    assert line["outcome"] == "accepted"


def free() -> object:
    """What is told of a robot that nobody stopped, whether it moves or not."""
    return {"offered": True, "seen": {"stopped": False, "standstill": False}}


def test_a_robot_that_does_not_answer_is_said_not_to(tmp_path: Path, domain: int) -> None:
    # A console of its own: it goes on asking, and would stop the robot of the next test.
    with serving(tmp_path / "audit", domain) as own, own.client() as client:
        wait_until(lambda: seen(own) == {"offered": True, "seen": None}, 20.0, "silence")
        answer = client.post(PATH)
    assert answer.status_code == 503
    assert answer.json()["detail"]["title"].startswith("STOP is not confirmed: no drive manager")
    assert "emergency stop on the robot" in answer.json()["detail"]["remedy"]


@pytest.mark.parametrize("origin", [None, "http://evil.example", "null"])
def test_no_other_page_presses_it(console: Served, origin: str | None) -> None:
    with console.client() as client:
        del client.headers["Origin"]
        headers = {} if origin is None else {"Origin": origin}
        answer = client.post(PATH, headers=headers)
    assert answer.status_code == 403
    assert "not from this console" in answer.json()["detail"]["title"]


def test_where_it_is_not_wanted_it_stops_nothing_and_says_so(tmp_path: Path, domain: int) -> None:
    with (
        running_stack(),
        serving(tmp_path / "audit", domain, stop_without_login=False) as own,
        own.client() as client,
        own.client(Role.VIEWER) as viewer,
    ):
        assert client.get(PATH).json() == {"offered": False, "seen": None}
        answer = client.post(PATH)
        assert answer.status_code == 403
        assert answer.json()["detail"]["title"].endswith("nothing was stopped.")
        wait_until(lambda: viewer.post("/api/stop").status_code == 200, 20.0, "the other way stops")
        [line] = [line for line in own.audited() if line["what"] == "stop without log-in"]
        assert line["outcome"] == "refused: STOP takes a log-in here"
        assert "stopped by" not in line["before"]


def test_a_flood_is_answered_and_bounded_and_keeps_nobody_from_stop(
    tmp_path: Path, domain: int
) -> None:
    with (
        running_stack(),
        serving(tmp_path / "audit", domain) as own,
        own.client(Role.VIEWER, user="ava") as viewer,
        ThreadPoolExecutor(16) as strangers,
    ):
        wait_until(lambda: viewer.post("/api/stop").status_code == 200, 30.0, "a drive manager")

        def press(_: int) -> int:
            with own.client() as client:
                return client.post(PATH).status_code

        flood = [strangers.submit(press, number) for number in range(100)]
        assert viewer.post("/api/stop").json()["accepted"]
        assert {pressed.result() for pressed in flood} == {200}
        lines = own.audited()
    pressed_without = [line for line in lines if line["what"] == "stop without log-in"]
    assert len(pressed_without) == 20  # of one address in a minute; the rest is counted


def test_wrong_log_ins_do_not_push_it_out_of_the_log(tmp_path: Path, domain: int) -> None:
    with serving(tmp_path / "audit", domain) as own, own.client() as client:
        for number in range(30):
            client.post("/api/login", json={"token": f"a wrong guess {number}"})
        client.post(PATH)
        wait_until(
            lambda: lines_after(own.audit_folder, 0)[-1]["what"] == "stop without log-in",
            5.0,
            "the line of STOP, after those of the log-ins",
        )
