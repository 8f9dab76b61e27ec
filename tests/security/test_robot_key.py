"""The robot's key is made once, is its owner's alone, and is the same for all who ask."""

from __future__ import annotations

import multiprocessing
import os
import stat
import struct
from multiprocessing.synchronize import Barrier
from pathlib import Path

import pytest

from kompass.store import robot_key as module
from kompass.store.robot_key import GIVEN, UnusableKey, known_keys, read_key, robot_key
from tests.support.stack import Stack

NAME = "KOMPASS_ROBOT_NAME"
DELETE = "delete it, and the robot makes a new one"
LAMP = """
from kompass.components import Component
from kompass.ros import Launcher

launcher = Launcher()
launcher.kompass(components=[Component(component_name="lamp")])
launcher.bringup()
"""


@pytest.fixture
def environment(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> dict[str, str]:
    """Of a process that has read no key yet."""
    monkeypatch.setattr(module, "_had", {})
    return {"KOMPASS_DATA_DIR": str(tmp_path / "data"), NAME: "r1"}


def file_of(environment: dict[str, str]) -> Path:
    return Path(environment["KOMPASS_DATA_DIR"]) / environment[NAME] / "robot.key"


def forget(monkeypatch: pytest.MonkeyPatch) -> None:
    """As a process that is started anew."""
    monkeypatch.setattr(module, "_had", {})


def test_it_is_its_owners_alone_whatever_the_umask_says(environment: dict[str, str]) -> None:
    before = os.umask(0)
    try:
        robot_key(environment)
    finally:
        os.umask(before)
    file = file_of(environment)
    assert file.stat().st_mode & 0o777 == 0o600
    assert {each.stat().st_mode & 0o777 for each in (file.parent, file.parent.parent)} == {0o700}
    assert list(file.parent.iterdir()) == [file]


def test_it_is_the_same_after_a_restart(
    environment: dict[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    made = robot_key(environment).text
    forget(monkeypatch)
    assert robot_key(environment).text == made
    assert file_of(environment).read_text().strip() == made


def _make(
    environment: dict[str, str], together: Barrier, out: multiprocessing.SimpleQueue[str]
) -> None:
    together.wait()
    out.put(robot_key(environment).text)


def test_those_who_make_it_at_once_have_the_same(environment: dict[str, str]) -> None:
    context = multiprocessing.get_context("fork")
    for number in range(5):
        own = {**environment, NAME: f"r{number}"}
        together, out = context.Barrier(8), context.SimpleQueue()
        several = [context.Process(target=_make, args=(own, together, out)) for _ in range(8)]
        for process in several:
            process.start()
        made = {out.get() for _ in several}
        for process in several:
            process.join()
        assert made == {file_of(own).read_text().strip()}
        assert list(file_of(own).parent.iterdir()) == [file_of(own)]


def test_robots_have_keys_of_their_own_and_their_user_knows_them_all(
    environment: dict[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    made = {robot_key({**environment, NAME: name}).text for name in ("r1", "r2", "r3")}
    assert len(made) == 3
    forget(monkeypatch)
    assert {key.text for key in known_keys(environment)} == made
    elsewhere = {**environment, "KOMPASS_DATA_DIR": environment["KOMPASS_DATA_DIR"] + "2"}
    assert known_keys(elsewhere) == []
    brought = {**elsewhere, GIVEN: str(file_of(environment))}
    assert [key.text for key in known_keys(brought)] == [read_key(file_of(environment)).text]
    assert robot_key(brought).text == read_key(file_of(environment)).text


@pytest.mark.parametrize(
    ("text", "mode", "said", "own", "given"),
    [
        (
            "no key\n",
            0o600,
            r"robot\.key is damaged: ",
            DELETE,
            "bring the robot's key there again",
        ),
        ("", 0o600, r"robot\.key is damaged: ", DELETE, "bring the robot's key there again"),
        (
            "0" * 64,
            0o640,
            r"can be read by others \(mode 640\): chmod 600 /",
            DELETE,
            "put a new one there and wherever it was brought",
        ),
        ("0" * 64, 0o604, r"can be read by others", DELETE, "put a new one there"),
    ],
)
def test_one_that_cannot_be_used_is_refused_with_a_remedy(
    environment: dict[str, str],
    text: str,
    mode: int,
    said: str,
    own: str,
    given: str,
    caplog: pytest.LogCaptureFixture,
) -> None:
    file = file_of(environment)
    file.parent.mkdir(parents=True)
    file.write_text(text)
    file.chmod(mode)
    with pytest.raises(UnusableKey, match=said) as refused:
        robot_key(environment)
    assert own in str(refused.value)
    assert file.read_text() == text  # nobody but a person takes it away
    with pytest.raises(UnusableKey, match=said) as refused:
        robot_key({GIVEN: str(file)})
    assert given in str(refused.value)
    assert DELETE not in str(refused.value), "the robot makes none where one was given"
    # Who only asks goes on with the keys that are good, and tells of this one.
    good = robot_key({**environment, NAME: "r2"})
    with caplog.at_level("WARNING"):
        known = known_keys({**environment, GIVEN: str(file)})
    assert [key.text for key in known] == [good.text]
    assert str(file) in caplog.text


def test_one_that_is_no_file_is_refused_at_once(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe, 0o600)
    for path in (pipe, Path("/dev/zero")):
        with pytest.raises(UnusableKey, match="is no regular file"):
            read_key(path)


def test_one_that_belongs_to_somebody_else_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    key = private_key(tmp_path)
    here = os.geteuid()
    monkeypatch.setattr(os, "geteuid", lambda: here + 1)
    monkeypatch.setattr(module, "_ROOT", here + 2)
    with pytest.raises(UnusableKey, match=rf"belongs to another user \({here}\).* chown"):
        read_key(key)
    monkeypatch.setattr(module, "_ROOT", here)  # root's is trusted
    assert read_key(key)


OWNER, USER, GROUP, NAMED_GROUP, MASK, OTHER = 0x01, 0x02, 0x04, 0x08, 0x10, 0x20


@pytest.mark.parametrize(
    ("entry", "good"),
    [
        ((USER, 4, "we"), True),  # as systemd opens a credential to the user of a unit
        ((USER, 4, "a stranger"), False),
        ((GROUP, 4, "nobody named"), False),
        ((NAMED_GROUP, 4, "a stranger"), False),
        ((OTHER, 4, "nobody named"), False),
    ],
)
def test_an_access_control_list_says_who_can_read_it(
    tmp_path: Path, entry: tuple[int, int, str], good: bool
) -> None:
    key = private_key(tmp_path)
    ids = {"we": os.geteuid(), "a stranger": os.geteuid() + 1, "nobody named": 2**32 - 1}
    rights = {(OWNER, 2**32 - 1): 4, (GROUP, 2**32 - 1): 0, (MASK, 2**32 - 1): 4}
    rights |= {(OTHER, 2**32 - 1): 0, (entry[0], ids[entry[2]]): entry[1]}
    entries = [struct.pack("<HHI", tag, allowed, whom) for (tag, whom), allowed in rights.items()]
    try:
        os.setxattr(key, "system.posix_acl_access", b"\2\0\0\0" + b"".join(sorted(entries)))
    except OSError as error:
        pytest.skip(f"no access control lists here: {error}")
    assert stat.S_IMODE(key.stat().st_mode) & 0o070 == 0o040
    if good:
        assert read_key(key)
    else:
        with pytest.raises(UnusableKey, match="can be read by others"):
            read_key(key)


def private_key(folder: Path) -> Path:
    key = folder / "robot.key"
    key.touch(0o600)
    key.write_text("0" * 64)
    return key


def test_one_that_was_named_and_is_not_there_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UnusableKey, match="none cannot be read: No such file"):
        robot_key({GIVEN: str(tmp_path / "none")})


def test_where_nothing_can_be_kept_the_stack_still_has_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    forget(monkeypatch)
    (tmp_path / "file").touch()
    nowhere = {"KOMPASS_DATA_DIR": str(tmp_path / "file"), NAME: "r1"}
    made = robot_key(nowhere)
    assert robot_key(nowhere) is made  # and so have its forks
    assert known_keys(nowhere) == [made]
    assert robot_key({}) is robot_key({})  # there is no home either


@pytest.mark.ros
def test_a_stack_whose_key_is_damaged_does_not_start_and_says_why(tmp_path: Path) -> None:
    (tmp_path / "lamp.py").write_text(LAMP)
    (tmp_path / "data" / "lamp").mkdir(parents=True)
    key = tmp_path / "data" / "lamp" / "robot.key"
    key.touch(0o600)
    key.write_text("rubbish")
    recipe = (str(tmp_path / "lamp.py"), "--name", "lamp", "--data-dir", str(tmp_path / "data"))
    stack = Stack("run", *recipe, "--no-browser", "--port", "0", KOMPASS_ROBOT_KEY="")
    assert stack.wait() == 1
    assert f"{key} is damaged" in stack.output
    assert "delete it, and the robot makes a new one" in stack.output
    key.unlink()
    again = Stack("run", *recipe, "--no-browser", "--port", "0", KOMPASS_ROBOT_KEY="")
    try:
        again.wait_for_line("all components active", 20)
    finally:
        again.close()
    assert read_key(key)


@pytest.mark.ros
def test_a_mode_that_is_none_is_refused_when_the_command_is_read() -> None:
    stack = Stack("demo", "--ros-control", "some", "--no-browser", "--port", "0")
    assert stack.wait() == 2
    assert "--ros-control some: give one of off, read, full" in stack.output
