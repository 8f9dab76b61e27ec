"""What the flight recorder keeps is listed, taken along and deleted, by those who may."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest

from kompass.recorder.mcap.writer import McapWriter
from kompass_console.schema.roles import Role
from tests.console.conftest import Served, serving

pytestmark = pytest.mark.ros

FROM, UNTIL = 1_700_000_000, 1_700_000_030  # s
FIRING = "firing-20231114T221320Z-near"


def recorded(path: Path, *times: float) -> Path:
    """A recording with one message at each of these times (s)."""
    path.parent.mkdir(parents=True, exist_ok=True)
    writer = McapWriter(path)
    channel = writer.add_channel("/chatter", "cdr", ("std_msgs/msg/Empty", "ros2msg", b""), {})
    for number, time in enumerate(times):
        writer.add_message(channel, int(time * 1e9), b"\0\1\0\0", int(time * 1e9), number)
    writer.finish()
    return path


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The robot's recordings, and a secret beside them."""
    root = tmp_path_factory.mktemp("robot")
    (root / "secret.mcap").write_text("not for you")
    recordings = root / "recordings"
    recorded(recordings / "ring" / "00000001-20231114T221300Z.mcap", FROM - 20)
    recorded(recordings / "saved" / "dock.mcap", FROM, UNTIL)
    recorded(recordings / "saved" / f"{FIRING}.mcap", FROM)
    (recordings / "saved" / "torn.mcap").write_bytes(b"nothing")
    (recordings / "saved" / ".dock.mcap.1.partial").write_bytes(b"")
    (recordings / "saved" / "link.mcap").symlink_to(root / "secret.mcap")
    return recordings


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory, domain: int, folder: Path) -> Iterator[Served]:
    """A console that runs beside these recordings."""
    audit = tmp_path_factory.mktemp("kept") / "audit"
    with serving(audit, domain, folder) as served:
        yield served


@pytest.fixture
def engineer(kept: Served) -> Iterator[httpx.Client]:
    with kept.client(Role.ENGINEER, user="ava") as client:
        yield client


def test_all_that_is_kept_is_listed_with_its_times_and_nothing_half_written(
    engineer: httpx.Client,
) -> None:
    found = engineer.get("/api/recordings").json()
    assert found["here"]
    assert found["free"] > 0
    assert found["ring"]["begin"] == FROM - 20
    named = {each["name"]: each for each in found["recordings"]}
    assert named.keys() == {"dock", FIRING, "torn"}
    dock = named["dock"]
    assert (dock["begin"], dock["end"], dock["messages"]) == (FROM, UNTIL, 2)
    assert not dock["of_firing"]
    assert not dock["problem"]
    assert named[FIRING]["of_firing"]
    assert named["torn"]["begin"] is None
    assert "torn.mcap is no MCAP file" in named["torn"]["problem"]


def test_a_recording_is_downloaded_whole_and_from_where_it_was_broken_off(
    kept: Served, folder: Path
) -> None:
    content = (folder / "saved" / "dock.mcap").read_bytes()
    with kept.client(Role.OPERATOR) as operator:
        whole = operator.get("/api/recordings/dock")
        assert whole.content == content
        assert 'filename="dock.mcap"' in whole.headers["content-disposition"]
        rest = operator.get("/api/recordings/dock", headers={"Range": "bytes=10-"})
    assert rest.status_code == 206
    assert rest.content == content[10:]


@pytest.mark.parametrize(
    "name",
    ["link", "..%2Fsecret", "..%2F..%2Fsecret", "%2Fetc%2Fpasswd", ".dock.mcap.1.partial", "none"],
)
def test_no_name_leads_out_of_the_folder(engineer: httpx.Client, folder: Path, name: str) -> None:
    assert engineer.get(f"/api/recordings/{name}").status_code == 404
    # A name with a slash is no name of a recording, and so no route either.
    assert engineer.delete(f"/api/recordings/{name}").status_code in (404, 405)
    assert (folder.parent / "secret.mcap").exists()
    assert (folder / "saved" / "dock.mcap").exists()


def test_only_an_engineer_deletes_and_it_is_in_the_audit_log(
    kept: Served, engineer: httpx.Client, folder: Path
) -> None:
    file = recorded(folder / "saved" / "old.mcap", FROM)
    for role in (Role.VIEWER, Role.OPERATOR):
        with kept.client(role) as client:
            refused = client.delete("/api/recordings/old")
            assert refused.status_code == 403
            assert "engineer" in refused.json()["detail"]["title"]
    with kept.client(Role.VIEWER) as viewer:
        assert viewer.get("/api/recordings").status_code == 200
        assert viewer.get("/api/recordings/old").status_code == 403
    assert file.exists()
    assert engineer.delete("/api/recordings/old").status_code == 204
    assert not file.exists()
    assert engineer.delete("/api/recordings/old").status_code == 404
    lines = [line for line in kept.audited() if line.get("name") == "old"]
    done = [(line["who"], line["outcome"]) for line in lines]
    assert done == [("ava", "done"), ("ava", "unknown")]
