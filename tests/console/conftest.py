"""A real console on a real socket, in this process; a stack for it to talk to, when asked."""

from __future__ import annotations

import contextlib
import os
import socket
import ssl
import subprocess
import sys
import threading
import uuid
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import httpx
import pytest

from kompass_console.audit.read import lines_after
from kompass_console.schema.roles import Role
from kompass_console.server import run_console
from kompass_console.settings import ConsoleSettings
from tests.support.processes import wait_until

TOKENS = {
    Role.VIEWER: "viewer-token-for-tests",
    Role.OPERATOR: "operator-token-for-tests",
    Role.ENGINEER: "engineer-token-for-tests",
}


@dataclass
class Served:
    """A running console: its address, and clients that talk to it as a page would."""

    listening: socket.socket
    audit_folder: Path
    certificate: Path | None = None

    @property
    def port(self) -> int:
        return int(self.listening.getsockname()[1])

    @property
    def origin(self) -> str:
        return f"{'https' if self.certificate else 'http'}://127.0.0.1:{self.port}"

    def audited(self) -> list[dict[str, Any]]:
        """All lines of the audit log about what was done so far, the oldest first."""
        mark = uuid.uuid4().hex
        with self.client(Role.VIEWER, user=mark):
            pass
        lines: list[dict[str, Any]] = []

        def marked() -> bool:
            lines[:] = lines_after(self.audit_folder, 0)
            return bool(lines) and lines[-1]["who"] == mark

        wait_until(marked, 5.0, "the line after all others")
        return lines[:-1]

    @contextlib.contextmanager
    def client(self, role: Role | None = None, user: str | None = None) -> Iterator[httpx.Client]:
        """An HTTP client with the page's Origin, logged in when a role is given."""
        headers = {"Origin": self.origin}
        trusted = ssl.create_default_context(cafile=self.certificate)
        with httpx.Client(
            base_url=self.origin, headers=headers, timeout=10.0, verify=trusted
        ) as client:
            if role is not None:
                answer = client.post("/api/login", json={"token": TOKENS[role], "user": user})
                assert answer.status_code == 200, answer.text
            yield client


def cookie_of(client: httpx.Client) -> str:
    """The Cookie header of a client."""
    return "; ".join(f"{name}={value}" for name, value in client.cookies.items())


@contextlib.contextmanager
def serving(
    audit_folder: Path, domain_id: int, recordings: Path | None = None, port: int = 0, **more: Any
) -> Iterator[Served]:
    """Serve a console for as long as the block lasts; `more` are other settings of it."""
    listening = socket.create_server(("127.0.0.1", port))
    settings = ConsoleSettings(
        robot_name="test robot",
        audit_folder=audit_folder,
        domain_id=domain_id,
        recordings=recordings,
        **{"access_tokens": TOKENS, **more},
    )
    stop = threading.Event()
    thread = threading.Thread(target=run_console, args=(listening, settings), kwargs={"stop": stop})
    thread.start()
    served = Served(listening, audit_folder, settings.tls_cert)
    try:
        with served.client() as client:
            wait_until(lambda: _answers(client), 20.0, "the console answers")
        yield served
    finally:
        stop.set()
        thread.join(10.0)
        assert not thread.is_alive(), "the console did not end"


def _answers(client: httpx.Client) -> bool:
    try:
        return client.get("/api/session").status_code == 401
    except httpx.TransportError:
        return False


@pytest.fixture(scope="module")
def domain() -> int:
    """This run's ROS domain."""
    return int(os.environ["ROS_DOMAIN_ID"])


@pytest.fixture(scope="module")
def console(tmp_path_factory: pytest.TempPathFactory, domain: int) -> Iterator[Served]:
    """A console; it hears whatever the module lets run in its domain."""
    with serving(tmp_path_factory.mktemp("console") / "audit", domain) as served:
        yield served


def running_stack(*options: str) -> contextlib.AbstractContextManager[subprocess.Popen[bytes]]:
    """A fake stack; `running_stack("--no-poses")` leaves something out."""
    return running("tests.console.fake_stack", *options)


@contextlib.contextmanager
def running(module: str, *options: str) -> Iterator[subprocess.Popen[bytes]]:
    """A stand-in for the far side of DDS, in a process of its own."""
    with subprocess.Popen([sys.executable, "-m", module, *options]) as process:
        try:
            yield process
        finally:
            process.terminate()
            try:
                process.wait(10.0)
            except subprocess.TimeoutExpired:
                # rclpy now and then waits for ever while it shuts down; the next test must not.
                process.kill()
