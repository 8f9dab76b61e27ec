"""Two machines on one cable: network namespaces of this kernel."""

from __future__ import annotations

import contextlib
import ctypes
import json
import os
import subprocess
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from tests.support.processes import wait_until


class Host(NamedTuple):
    """A network of its own, and an address in it."""

    namespace: str
    address: str

    @contextlib.contextmanager
    def inside(self) -> Iterator[None]:
        """This thread is on this host, and so is what it starts meanwhile."""
        libc = ctypes.CDLL(None, use_errno=True)
        with (
            Path("/proc/thread-self/ns/net").open() as here,
            Path("/run/netns", self.namespace).open() as there,
        ):
            _enter(libc, there.fileno())
            try:
                yield
            finally:
                _enter(libc, here.fileno())

    def plug(self, plugged: bool) -> None:
        """Put the cable in, or pull it out."""
        _ip("-n", self.namespace, "link", "set", "cable", "up" if plugged else "down")

    @property
    def enter(self) -> list[str]:
        """What a command is put behind to run on this host, as from a shell that knows no ROS."""
        without = ("ROS_AUTOMATIC_DISCOVERY_RANGE", "FASTRTPS_DEFAULT_PROFILES_FILE")
        unset = [part for name in without for part in ("--unset", name)]
        return ["ip", "netns", "exec", self.namespace, "env", *unset]


@contextlib.contextmanager
def two_hosts() -> Iterator[tuple[Host, Host]]:
    """Two hosts that reach each other and nobody else; the test is skipped where that is barred."""
    mark = f"kompass-{os.getpid()}"
    # Addresses that documentation may use, and nobody else.
    hosts = Host(f"{mark}-a", "198.51.100.1"), Host(f"{mark}-b", "198.51.100.2")
    try:
        for host in hosts:
            _ip("netns", "add", host.namespace)
        near, far = hosts
        _ip(
            *("link", "add", "cable", "netns", near.namespace, "type", "veth"),
            *("peer", "name", "cable", "netns", far.namespace),
        )
        for host in hosts:
            _ip("-n", host.namespace, "addr", "add", f"{host.address}/24", "dev", "cable")
            for link in ("lo", "cable"):
                _ip("-n", host.namespace, "link", "set", link, "up")
        for host in hosts:
            wait_until(partial(_is_up, host), 10, f"the cable of {host.namespace}")
    except (OSError, subprocess.CalledProcessError) as error:
        said = getattr(error, "stderr", "") or error
        _remove(hosts)
        pytest.skip(f"this machine lets nobody make network namespaces: {said}")
    try:
        yield hosts
    finally:
        _remove(hosts)


def _enter(libc: ctypes.CDLL, namespace: int) -> None:
    if libc.setns(namespace, 0):
        number = ctypes.get_errno()
        raise OSError(number, os.strerror(number))


def _ip(*arguments: str) -> str:
    return subprocess.run(
        ["ip", *arguments], check=True, capture_output=True, text=True, timeout=10
    ).stdout


def _is_up(host: Host) -> bool:
    links: list[dict[str, Any]] = json.loads(
        _ip("-n", host.namespace, "-json", "addr", "show", "cable")
    )
    # An address that is still tentative has no multicast yet.
    tentative = any(each.get("tentative") for each in links[0]["addr_info"])
    return links[0]["operstate"] == "UP" and not tentative


def _remove(hosts: tuple[Host, Host]) -> None:
    for host in hosts:
        with contextlib.suppress(OSError, subprocess.CalledProcessError):
            _ip("netns", "delete", host.namespace)
