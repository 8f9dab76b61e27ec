"""A file is replaced as a whole, or not at all."""

import resource
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest

from kompass.store.durable import write_whole

ROOM = 1000  # bytes


@pytest.fixture
def little_room() -> Iterator[None]:
    """The kernel lets this process write no file that is larger: it fails as on a full disk."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    handled = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (ROOM, before[1]))
    yield
    resource.setrlimit(resource.RLIMIT_FSIZE, before)
    signal.signal(signal.SIGXFSZ, handled)


def test_a_file_is_replaced_and_only_its_owner_reads_it(tmp_path: Path) -> None:
    path = tmp_path / "zones.json"
    for data in (b"one", b"two"):
        write_whole(path, data)
        assert path.read_bytes() == data
    assert path.stat().st_mode & 0o777 == 0o600
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.usefixtures("little_room")
def test_without_room_all_is_left_as_it_was(tmp_path: Path) -> None:
    path = tmp_path / "zones.json"
    write_whole(path, b"old")
    with pytest.raises(OSError, match="too large"):
        write_whole(path, b"x" * (ROOM + 1))
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


def test_what_a_power_cut_left_behind_is_no_hindrance(tmp_path: Path) -> None:
    (tmp_path / "zones.json.new").write_bytes(b"half")
    write_whole(tmp_path / "zones.json", b"whole")
    assert [each.name for each in tmp_path.iterdir()] == ["zones.json"]
