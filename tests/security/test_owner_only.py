"""What a robot keeps on its disk is its owner's alone, whatever the umask says."""

import os
from collections.abc import Iterator
from itertools import groupby
from pathlib import Path

import httpx
import pytest

from kompass_console.audit.read import lines_after
from kompass_console.audit.verify import verify
from tests.support.processes import wait_until
from tests.support.stack import TOKEN, Stack

pytestmark = [pytest.mark.ros, pytest.mark.slow]


@pytest.fixture
def usual_umask() -> Iterator[None]:
    before = os.umask(0o022)
    try:
        yield
    finally:
        os.umask(before)


@pytest.mark.usefixtures("usual_umask")
def test_every_file_and_folder_of_a_run_is_its_owners_alone(tmp_path: Path) -> None:
    folder = tmp_path / "not" / "there" / "yet"
    stack = Stack.simulated(KOMPASS_DATA_DIR=str(folder), KOMPASS_ROBOT_KEY="")
    try:
        client = httpx.Client(base_url=stack.url, headers={"Origin": stack.url}, timeout=15.0)
        with client:
            assert client.post("/api/login", json={"token": TOKEN}).is_success

            def kept() -> bool:
                body = {"seconds": 0, "name": "kept"}
                return client.post("/api/recordings", json=body).status_code == 201

            wait_until(kept, 20, "something was recorded and kept")
            view = client.get("/api/rules").json()
            changed = {**view["table"], "rules": []}
            body = {"table": changed, "expected_revision": view["revision"], "probation": 0}
            assert client.post("/api/rules/apply", json=body).is_success
            pressed = lambda: client.post("/api/stop").is_success  # noqa: E731
            wait_until(pressed, 20, "the console has found the drive manager")
        wait_until(lambda: list(folder.glob("*/audit/*.jsonl")), 10, "the audit log")
        while_it_runs = modes(folder)
    finally:
        stack.close()
    [log] = folder.glob("*/audit")
    assert verify(log).broken == ""
    # Some are done again and again, until they are answered.
    deeds = [what for what, _ in groupby(line["what"] for line in lines_after(log, 0))]
    assert deeds == ["log in", "save recording", "apply rules", "stop"]
    for found in (while_it_runs, modes(folder)):
        names = {Path(name).name for name in found}
        assert "robot.key" in names
        assert {"rules.db", "journal.db", "kept.mcap", "ring", "end.json", "audit.lock"} <= names
        for name, mode in found.items():
            assert mode in (0o40700, 0o100600, 0o140600), f"{name} is {oct(mode)}"


def modes(folder: Path) -> dict[str, int]:
    """Kind and rights of all that is in a folder, by path."""
    found = {}
    for path in [folder, *folder.rglob("*")]:
        try:
            found[str(path)] = path.lstat().st_mode & 0o170777
        except FileNotFoundError:  # the recorder has gone over it
            continue
    return found
