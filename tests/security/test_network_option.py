"""Who is met over ROS is what was asked for, else what the environment says, else this machine."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from kompass.access.ros_control import ROS_CONTROL, ros_control
from kompass.rclpy_ext.middleware import LOOPBACK, PEERS, PROFILES, RANGE, SUBNET_PROFILE
from kompass_console.cli_error import CliError
from kompass_console.domain import LOCALHOST_ONLY, choose_domain, choose_ros_control


@pytest.fixture(autouse=True)
def nothing_said(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """An environment that says nothing of the network, and is there again after the test."""
    monkeypatch.setenv("ROS_DOMAIN_ID", "7")
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    for name in (RANGE, PEERS, PROFILES, LOCALHOST_ONLY):
        monkeypatch.setenv(name, "")
        monkeypatch.delenv(name)


def test_unless_it_is_told_otherwise_a_command_keeps_to_this_machine() -> None:
    assert choose_domain(None, None) == "ROS domain 7, on this machine only (--network local)"
    assert os.environ[PROFILES] == str(LOOPBACK)


def test_the_subnet_is_met_when_asked_for() -> None:
    said = choose_domain(3, "subnet")
    assert said == "ROS domain 3, on the whole subnet (--network subnet)"
    assert os.environ[RANGE] == "SUBNET"
    assert os.environ[PROFILES] == str(SUBNET_PROFILE)
    text = SUBNET_PROFILE.read_text()
    assert "WhiteList" not in text
    assert "initialPeers" not in text


def test_peers_are_met_when_named() -> None:
    said = choose_domain(None, "198.51.100.7,198.51.100.8")
    assert "on this machine and 198.51.100.7, 198.51.100.8 (" in said
    assert "<address>198.51.100.8</address>" in Path(os.environ[PROFILES]).read_text()


@pytest.mark.parametrize(
    ("name", "value", "where"),
    [
        (RANGE, "SUBNET", "on the whole subnet"),
        (RANGE, "LOCALHOST", "on this machine only"),
        (RANGE, "OFF", "on no network"),
        (LOCALHOST_ONLY, "1", "on this machine only"),
        (PEERS, "198.51.100.7", "on this machine and 198.51.100.7"),
        (PROFILES, "/etc/mine.xml", "on the network that"),
    ],
)
def test_what_the_environment_says_is_respected_and_named(
    monkeypatch: pytest.MonkeyPatch, name: str, value: str, where: str
) -> None:
    monkeypatch.setenv(name, value)
    said = choose_domain(None, None)
    assert where in said
    assert f"as {name} in the environment says" in said


def test_the_option_comes_before_the_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(RANGE, "SUBNET")
    monkeypatch.setenv(PEERS, "198.51.100.7")
    assert "on this machine only" in choose_domain(None, "local")
    assert PEERS not in os.environ


@pytest.mark.parametrize(
    ("given", "environment", "mode", "said"),
    [
        (None, "", "read", ""),
        ("read", "full", "read", ""),
        ("full", "", "full", "whoever is met there may change everything (--ros-control full)"),
        (None, "full", "full", "may change everything"),
        ("off", "", "off", "is not even answered (--ros-control off)"),
    ],
)
def test_what_may_be_done_without_the_key_is_what_was_asked_for_and_said_at_the_start(
    monkeypatch: pytest.MonkeyPatch, given: str | None, environment: str, mode: str, said: str
) -> None:
    monkeypatch.setenv(ROS_CONTROL, environment)
    words = choose_ros_control(given)
    assert ros_control() == mode
    assert said in words
    assert bool(words) == bool(said)


def test_a_profile_of_the_users_own_is_not_overruled_in_silence(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv(PROFILES, "/etc/mine.xml")
    with pytest.raises(CliError, match=r"--network local cannot .*/etc/mine.xml .*unset one"):
        choose_domain(None, "local")
    assert os.environ[PROFILES] == "/etc/mine.xml"


@pytest.mark.parametrize("network", ["", "local,198.51.100.7", "no such name", "198.51.100.7,,"])
def test_a_network_that_is_none_is_refused_with_what_it_may_be(network: str) -> None:
    with pytest.raises(CliError, match=f"--network {network}: ") as refused:
        choose_domain(None, network)
    assert refused.value.code == 2
