"""The environment is put right, or what is wrong with it is told, before ROS is touched."""

from pathlib import Path

import pytest

from kompass.launch.environment import EnvironmentProblem, check_environment
from kompass.rclpy_ext.middleware import (
    LOOPBACK,
    MIDDLEWARE,
    PEERS,
    PROFILES,
    RANGE,
    SUBNET_PROFILE,
    TRANSPORTS,
    prepare_middleware,
)
from kompass.supervisor.instance_lock import AlreadyRunning, lock_instance


def test_messages_go_by_udp() -> None:
    environment: dict[str, str] = {}
    prepare_middleware(environment)
    assert environment == {TRANSPORTS: "UDPv4", PROFILES: str(SUBNET_PROFILE)}


@pytest.mark.parametrize("reach", ["", "SUBNET", "LOCALHOST"])
def test_sockets_ask_for_room_wherever_others_are_looked_for(reach: str) -> None:
    environment = {RANGE: reach}
    prepare_middleware(environment)
    assert "BufferSize>4194304<" in Path(environment[PROFILES]).read_text()


def test_who_keeps_to_this_machine_later_does() -> None:
    environment: dict[str, str] = {}
    prepare_middleware(environment)
    environment[RANGE] = "LOCALHOST"
    prepare_middleware(environment)
    assert environment[PROFILES] == str(LOOPBACK)


def test_this_machine_only_is_a_profile_without_shared_memory() -> None:
    environment = {RANGE: "LOCALHOST"}
    prepare_middleware(environment)
    assert environment[RANGE] == "SYSTEM_DEFAULT"
    text = Path(environment[PROFILES]).read_text()
    assert "127.0.0.1" in text
    assert "SHM" not in text


def test_what_the_user_has_chosen_stays() -> None:
    environment = {RANGE: "LOCALHOST", PROFILES: "/etc/mine.xml"}
    prepare_middleware(environment)
    assert environment == {RANGE: "LOCALHOST", PROFILES: "/etc/mine.xml"}


def test_peers_of_this_machine_are_looked_for_without_shared_memory(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    environment = {RANGE: "LOCALHOST", PEERS: "198.51.100.7; 198.51.100.8"}
    prepare_middleware(environment)
    text = Path(environment[PROFILES]).read_text()
    for address in ("127.0.0.1", "198.51.100.7", "198.51.100.8"):
        assert f"<address>{address}</address>" in text
    assert "SHM" not in text


def test_a_peer_that_is_not_known_opens_nothing(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    environment = {RANGE: "LOCALHOST", PEERS: "198.51.100.7;no such name"}
    prepare_middleware(environment)
    assert environment[RANGE] == "LOCALHOST"
    assert PROFILES not in environment


def test_another_middleware_is_told_of_the_range_itself() -> None:
    environment = {RANGE: "LOCALHOST", MIDDLEWARE: "rmw_cyclonedds_cpp"}
    prepare_middleware(environment)
    assert environment == {RANGE: "LOCALHOST", MIDDLEWARE: "rmw_cyclonedds_cpp"}


def test_a_folder_that_others_own_does_not_say_who_is_met(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    import os

    if os.getuid() != 0:
        pytest.skip("only root can give a folder to somebody else")
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    folder = tmp_path / f"kompass-{os.getuid()}"
    folder.mkdir()
    os.chown(folder, 65534, 65534)
    with pytest.raises(PermissionError, match="set XDG_RUNTIME_DIR"):
        prepare_middleware({RANGE: "LOCALHOST", PEERS: "198.51.100.7"})


def test_a_missing_middleware_is_told_with_the_remedy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("RMW_IMPLEMENTATION", "rmw_nowhere_cpp")
    with pytest.raises(EnvironmentProblem, match="unset RMW_IMPLEMENTATION"):
        check_environment()


def test_an_impossible_domain_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", "300")
    with pytest.raises(EnvironmentProblem, match="from 0 to 232"):
        check_environment()


def test_a_name_on_a_domain_is_claimed_once(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    import os

    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    monkeypatch.setenv("ROS_DOMAIN_ID", "7")
    held = lock_instance(["planner"])
    with pytest.raises(AlreadyRunning, match="'planner' on ROS domain 7"):
        lock_instance(["planner"])
    claimed_elsewhere = lock_instance(["planner"], namespace="robot2")
    monkeypatch.setenv("ROS_DOMAIN_ID", "8")
    on_another_domain = lock_instance(["planner"])
    for descriptor in [*held, *claimed_elsewhere, *on_another_domain]:
        os.close(descriptor)
    monkeypatch.setenv("ROS_DOMAIN_ID", "7")
    for descriptor in lock_instance(["planner"]):
        os.close(descriptor)
