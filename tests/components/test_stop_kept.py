"""STOP outlives the whole stack; what nobody can read counts as STOP."""

import json
import shutil
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from geometry_msgs.msg import Twist
from kompass_interfaces.msg import DriveState
from kompass_interfaces.srv import ReleaseStop, StopRobot

from kompass.components import DriveManager
from kompass.components.drive.stop_file import SIZE, StopFile, StopKeeper
from kompass.components.drive.stop_latch import StopLatch, StopRecord
from tests.components.alive import LATCHED, Alive
from tests.support.disk import no_larger_than
from tests.support.processes import wait_until

pytestmark = pytest.mark.ros

AVA = StopRecord("ava", "somebody in the way", 1.7e9)


def file_in(folder: Path) -> StopFile:
    return StopFile(folder / "robot" / "stop-gate.json")


def test_a_stop_that_is_on_disk_says_who_why_and_when(tmp_path: Path) -> None:
    file_in(tmp_path).write(AVA)
    assert file_in(tmp_path).load() == AVA
    latch = StopLatch()
    latch.load(file_in(tmp_path).load())
    assert (latch.is_set, latch.operator, latch.reason) == (True, "ava", "somebody in the way")
    assert latch.account == "somebody in the way (pressed 2023-11-14 22:13 UTC, before this start)"


def test_a_release_is_on_disk_too_and_a_robot_without_the_file_is_free(tmp_path: Path) -> None:
    assert file_in(tmp_path).load() is None
    file = file_in(tmp_path)
    file.write(AVA)
    file.write(None)
    assert file_in(tmp_path).load() is None


@pytest.mark.parametrize("length", [15, 40, 70])
def test_a_write_that_was_cut_short_counts_as_stop(tmp_path: Path, length: int) -> None:
    file = file_in(tmp_path)
    file.write(None)
    before = file.path.read_bytes()
    file.write(AVA)
    after = file.path.read_bytes()
    for one, other in ((before, after), (after, before)):
        file.path.write_bytes(one[:length] + other[length:])
        assert file_in(tmp_path).load() is not None


@pytest.mark.parametrize("text", ["", "{}", "[]", "null", '{"stopped": 1}', '{"stopped": null}'])
def test_what_makes_no_sense_counts_as_stop(tmp_path: Path, text: str) -> None:
    file = file_in(tmp_path)
    file.write(None)
    file.path.write_text(text)
    kept = file_in(tmp_path).load()
    assert kept is not None
    assert "is damaged" in kept.reason


def test_what_is_no_file_counts_as_stop(tmp_path: Path) -> None:
    file = file_in(tmp_path)
    file.path.mkdir(parents=True)
    kept = file.load()
    assert kept is not None
    assert "cannot be read" in kept.reason


def test_only_the_owner_may_read_or_write_it(tmp_path: Path) -> None:
    file = file_in(tmp_path)
    file.write(None)
    assert file.path.stat().st_mode & 0o777 == 0o600
    assert file.path.parent.stat().st_mode & 0o777 == 0o700
    file.close()
    file.path.chmod(0o666)
    file.write(AVA)
    assert file.path.stat().st_mode & 0o777 == 0o600


def test_it_is_never_written_through_a_link(tmp_path: Path) -> None:
    file = file_in(tmp_path)
    target = tmp_path / "victim"
    target.write_text("whole")
    file.path.parent.mkdir()
    file.path.symlink_to(target)
    with pytest.raises(OSError, match="symbolic links"):
        file.write(AVA)
    assert target.read_text() == "whole"


def test_two_stacks_do_not_keep_their_stop_in_one_file(tmp_path: Path) -> None:
    file_in(tmp_path)
    first, second = file_in(tmp_path), file_in(tmp_path)
    first.write(None)
    with pytest.raises(OSError, match="another stack keeps its STOP"):
        second.write(AVA)
    first.close()
    second.write(AVA)


def test_a_file_that_was_taken_away_is_made_anew(tmp_path: Path) -> None:
    file = file_in(tmp_path)
    file.write(None)
    shutil.rmtree(file.path.parent)
    file.write(AVA)
    assert file_in(tmp_path).load() == AVA


def test_what_could_not_be_written_is_said_and_tried_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "robot").write_text("in the way of the folder")
    said: list[str] = []
    keeper = StopKeeper(file_in(tmp_path), ThreadPoolExecutor(1), said.append)
    keeper.keep(AVA)
    wait_until(lambda: said, 5, "word of the disk")
    assert "see to its disk and owner" in said[0]
    (tmp_path / "robot").unlink()

    def is_written() -> bool:
        keeper.retry()
        return file_in(tmp_path).load() == AVA

    wait_until(is_written, 5, "the STOP on disk")
    keeper.close()
    assert len(said) == 1


Run = Callable[..., Alive]


class Operator:
    """Presses and releases STOP of a running drive manager."""

    def __init__(self, alive: Alive) -> None:
        self._alive = alive
        self.states: list[DriveState] = alive.hear(DriveState, "drive_state", LATCHED)
        self.commands: list[Twist] = alive.hear(Twist, "/cmd_vel")
        wait_until(lambda: self.states, 10, "the first state")

    def press(self, reason: str = "a test") -> None:
        request = StopRobot.Request(operator_name="ava", reason=reason)
        assert self._alive.call(StopRobot, "stop", request).success

    def release(self) -> ReleaseStop.Response:
        request = ReleaseStop.Request(operator_name="ava")
        answer = self._alive.call(ReleaseStop, "release_stop", request)
        assert isinstance(answer, ReleaseStop.Response)
        return answer


def kept(folder: Path) -> object:
    return json.loads((folder / "stop-drive_manager.json").read_text())["stopped"]


def test_a_robot_that_was_stopped_comes_up_stopped(run_on_dds: Run, data_folder: Path) -> None:
    first = run_on_dds(DriveManager())
    operator = Operator(first)
    operator.press("somebody in the way")
    wait_until(lambda: kept(data_folder) is True, 5, "the STOP on disk")
    first.close()
    second = run_on_dds(DriveManager())
    state = Operator(second).states[0]
    assert state.stopped
    assert state.stopped_by == "ava"
    day = time.strftime("%Y-%m-%d", time.gmtime())
    assert state.reason.startswith(f"somebody in the way (pressed {day} ")
    assert Operator(second).release().message == "released"
    assert kept(data_folder) is False
    second.close()
    assert not Operator(run_on_dds(DriveManager())).states[0].stopped


def test_a_stop_just_before_the_end_is_kept(run_on_dds: Run, data_folder: Path) -> None:
    alive = run_on_dds(DriveManager())
    Operator(alive).press()
    alive.close()
    assert kept(data_folder) is True


def test_a_damaged_file_stops_the_robot_until_a_person_releases_it(
    run_on_dds: Run, data_folder: Path
) -> None:
    data_folder.mkdir()
    (data_folder / "stop-drive_manager.json").write_bytes(b"\0" * SIZE)
    operator = Operator(run_on_dds(DriveManager()))
    assert operator.states[0].stopped
    assert "stop-drive_manager.json is damaged" in operator.states[0].reason
    assert operator.release().success
    assert kept(data_folder) is False


def test_a_full_disk_keeps_stop_and_release_all_the_same(
    run_on_dds: Run, data_folder: Path
) -> None:
    operator = Operator(run_on_dds(DriveManager()))
    wait_until(lambda: kept(data_folder) is False, 5, "the file")
    with no_larger_than(SIZE):
        operator.press()
        wait_until(lambda: kept(data_folder) is True, 5, "the STOP on disk")
        assert operator.release().message == "released"
    assert kept(data_folder) is False


def test_a_release_that_cannot_be_kept_says_so_and_what_to_see_to(
    run_on_dds: Run, data_folder: Path
) -> None:
    operator = Operator(run_on_dds(DriveManager()))
    operator.press()
    wait_until(lambda: kept(data_folder) is True, 5, "the STOP on disk")
    path = data_folder / "stop-drive_manager.json"
    path.rename(data_folder / "aside")
    path.mkdir()
    answer = operator.release()
    assert answer.success
    assert "it may come up stopped when it is started anew: cannot write" in answer.message
    assert "see to its disk and owner" in answer.message
    wait_until(lambda: not operator.states[-1].stopped, 5, "the release")
    path.rmdir()


class HangingDisk:
    """Whoever waits for the disk waits for :meth:`go_on`."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.waits, self._goes_on = threading.Event(), threading.Event()
        monkeypatch.setattr("kompass.components.drive.stop_file.os.fdatasync", self._sync)

    def _sync(self, _descriptor: int) -> None:
        self.waits.set()
        self._goes_on.wait(60)

    def go_on(self) -> None:
        self._goes_on.set()


def test_stop_waits_for_no_disk_and_beats_a_release_that_does(
    run_on_dds: Run, data_folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("kompass.components.drive.drive_manager.SLOW_DISK", 60.0)
    alive = run_on_dds(DriveManager())
    operator = Operator(alive)
    operator.press()
    wait_until(lambda: kept(data_folder) is True, 5, "the STOP on disk")
    disk = HangingDisk(monkeypatch)
    released = alive.begin(ReleaseStop, "release_stop", ReleaseStop.Request(operator_name="ben"))
    wait_until(disk.waits.is_set, 5, "the release on its way to the disk")
    assert released() is None
    operator.press("again")
    assert operator.states[-1].stopped
    disk.go_on()
    wait_until(lambda: released() is not None, 5, "the answer")
    assert not released().success
    assert released().message == "STOP was pressed again meanwhile"
    wait_until(lambda: kept(data_folder) is True, 5, "the STOP on disk")
    assert operator.states[-1].stopped


def test_a_disk_that_does_not_answer_does_not_hold_a_release_for_long(
    run_on_dds: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    operator = Operator(run_on_dds(DriveManager()))
    disk = HangingDisk(monkeypatch)
    operator.press()
    answer = operator.release()
    assert answer.success
    assert "the disk has not answered" in answer.message
    disk.go_on()


def test_without_a_folder_for_data_stop_works_and_is_not_kept(
    run_on_dds: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROS_LOG_DIR", str(tmp_path))
    for name in ("KOMPASS_DATA_DIR", "XDG_STATE_HOME", "HOME"):
        monkeypatch.delenv(name, raising=False)
    operator = Operator(run_on_dds(DriveManager()))
    operator.press()
    wait_until(lambda: operator.states[-1].stopped, 5, "STOP")
    assert operator.release().message == "released"
