"""A console tells a webhook what happens to the robot, and its pages when it does not arrive."""

from __future__ import annotations

from pathlib import Path

import pytest

from kompass_console.schema.roles import Role
from kompass_console.webhooks.settings import Webhook
from tests.console.conftest import running_stack, serving
from tests.console.test_link import listening, until
from tests.support.processes import wait_until
from tests.webhooks.receiver import receiving

pytestmark = pytest.mark.ros


def test_a_stop_is_told_to_a_server_and_one_that_fails_is_told_to_pages(
    tmp_path: Path, domain: int
) -> None:
    with (
        receiving() as receiver,
        receiving() as failing,
        running_stack(),
        serving(
            tmp_path / "audit",
            domain,
            webhooks=(
                Webhook(url=receiver.url, kinds=("stop",)),
                Webhook(url=failing.url, kinds=("stop",)),
            ),
        ) as own,
        own.client(Role.OPERATOR, user="ava") as client,
        listening(own, client) as socket,
    ):
        failing.status = 400
        seen = until(socket, lambda state: state["drive"])["time"]
        # Webhooks look twice a second, and what was so at first is no news to them.
        until(socket, lambda state: state["time"] > seen + 2.0)
        assert client.post("/api/stop").json()["accepted"]
        wait_until(lambda: receiver.told, 30.0, "the notice")
        [told] = receiver.told[:1]
        assert (told["kind"], told["robot"], told["urgent"]) == ("stop", "test robot", True)
        assert told["title"].startswith("Stopped by ava")
        said = until(socket, lambda state: state["webhook_problem"])
        place = f"http://127.0.0.1:{failing.port}"
        assert said["webhook_problem"] == f"The webhook {place} takes no notices: it answers 400."
