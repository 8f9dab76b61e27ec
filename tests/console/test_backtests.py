"""Back-tests are begun, watched, cancelled and told apart."""

from __future__ import annotations

import subprocess
from collections.abc import Iterator

import httpx
import pytest

from kompass_console.schema.roles import Role
from tests.console.conftest import Served
from tests.console.rules_client import Json, await_monitor, running_monitor, table
from tests.support.processes import wait_until

pytestmark = pytest.mark.ros


@pytest.fixture(scope="module")
def monitor(console: Served) -> Iterator[subprocess.Popen[bytes]]:
    with running_monitor() as process, console.client(Role.VIEWER) as client:
        await_monitor(client)
        yield process


@pytest.fixture
def operator(console: Served, monitor: subprocess.Popen[bytes]) -> Iterator[httpx.Client]:
    with console.client(Role.OPERATOR) as client:
        yield client


def begin(client: httpx.Client, recording: str = "") -> str:
    """Begin one; its id."""
    answer: httpx.Response | None = None

    def begun() -> bool:
        nonlocal answer
        answer = client.post("/api/backtests", json={"table": table(), "recording": recording})
        return answer.status_code == 202

    wait_until(begun, 30.0, "the monitor takes a back-test")
    assert answer is not None
    return str(answer.json()["id"])


def ended(client: httpx.Client, job: str) -> Json:
    """How it ended."""
    progress: Json = {}

    def over() -> bool:
        progress.update(client.get(f"/api/backtests/{job}").json())
        return progress["state"] not in ("waiting", "running")

    wait_until(over, 30.0, "the end of the back-test")
    return progress


def test_a_report_comes_with_the_end(operator: httpx.Client) -> None:
    progress = ended(operator, begin(operator))
    assert (progress["state"], progress["progress"], progress["error"]) == ("done", 1.0, None)
    assert progress["report"]["messages"] == 1


def test_a_failure_says_why(operator: httpx.Client) -> None:
    progress = ended(operator, begin(operator, "broken"))
    assert (progress["state"], progress["report"]) == ("failed", None)
    assert progress["error"] == "it is no recording"


def test_two_may_run_and_cancelling_one_makes_room(operator: httpx.Client) -> None:
    jobs = [begin(operator, "endless") for _ in range(2)]
    wait_until(
        lambda: operator.get(f"/api/backtests/{jobs[0]}").json()["progress"] == 0.5, 5.0, "progress"
    )
    refused = operator.post("/api/backtests", json={"table": table()})
    assert refused.status_code == 429
    for job in jobs:
        assert operator.delete(f"/api/backtests/{job}").status_code == 204
        assert ended(operator, job)["state"] == "canceled"
    assert operator.delete(f"/api/backtests/{jobs[0]}").status_code == 204
    assert operator.get(f"/api/backtests/{jobs[0]}").status_code == 404
    assert ended(operator, begin(operator))["state"] == "done"


def test_a_monitor_that_is_started_again_has_lost_its_back_tests(
    operator: httpx.Client, monitor: subprocess.Popen[bytes]
) -> None:
    """The last test of the module: its monitor does not outlive it."""
    job = begin(operator, "endless")
    monitor.kill()
    with running_monitor():
        progress = ended(operator, job)
        assert progress["state"] == "failed"
        assert "gone" in progress["error"]
        assert ended(operator, begin(operator))["state"] == "done"
