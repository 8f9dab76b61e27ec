"""Questions to the monitor from its own machine: without ROS, whose discovery takes seconds.

A Unix socket in the robot's folder, beside its key: who may open it could sign requests as well, so
that it needs no signature. It answers what only looks. One question a connection, one JSON document
each way.
"""

from __future__ import annotations

import json
import os
import re
import socket
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

from kompass.store.paths import data_dir, robot_folder

PATIENCE = 1.0  # s for whoever asks to write
READING = 5.0  # s for whoever asks to read: it may be loading what it prints with
ENDING = 0.5  # s for the answer under way: a robot that goes down waits for nobody who reads slowly
MOST = 64_000  # characters of a question
_NAME = re.compile(r"monitor\.(\d+)\.([\w.]+)\.sock")


class LocalAnswer(NamedTuple):
    """What the monitor says: a JSON document, or why there is none."""

    success: bool
    message: str
    answer: str


class LocalMonitor(NamedTuple):
    """A monitor that can be asked.

    Attributes
    ----------
    name
        Of its node, with the namespace: ``/monitor``.
    socket
        Where it listens.
    """

    name: str
    socket: Path


class LocalSocket:
    """Listens until it is closed, and answers one question after another.

    Parameters
    ----------
    domain
        ROS domain of the monitor.
    name
        Of its node, with the namespace.
    answer
        Takes the name of a service and the fields of its request; called on a thread of this
        object. What it raises is the answer, as a sentence.

    Raises
    ------
    OSError
        When the socket cannot be made, or somebody listens on it already.
    """

    def __init__(
        self, domain: int, name: str, answer: Callable[[str, Mapping[str, Any]], LocalAnswer]
    ) -> None:
        self._answer = answer
        self._path = robot_folder() / f"monitor.{domain}{name.replace('/', '.')}.sock"
        self._socket = socket.socket(socket.AF_UNIX)
        try:
            if _listens(self._path):
                raise FileExistsError(f"another monitor listens on {self._path}")
            self._path.unlink(missing_ok=True)
            with _short(self._path) as path:
                self._socket.bind(path)
            self._path.chmod(0o600)
            self._socket.listen()
        except BaseException:
            self._socket.close()
            raise
        self._thread = threading.Thread(target=self._serve, name="local socket", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Answer nobody any more; the answer under way has a moment to end."""
        self._path.unlink(missing_ok=True)
        self._socket.shutdown(socket.SHUT_RD)
        self._thread.join(ENDING)
        self._socket.close()

    def _serve(self) -> None:
        while True:
            try:
                client, _ = self._socket.accept()
            except OSError:  # closed
                return
            with client:
                try:
                    client.settimeout(PATIENCE)
                    answer = self._respond(_read(client, MOST))
                    client.settimeout(READING)
                    client.sendall(json.dumps(answer._asdict()).encode())
                except OSError:
                    continue  # who says nothing, does not read, or went away, holds nobody up

    def _respond(self, text: bytes) -> LocalAnswer:
        try:
            asked = json.loads(text)
            return self._answer(asked["service"], asked["request"])
        except Exception as error:  # noqa: BLE001 - whoever asks is told
            return LocalAnswer(False, str(error) or type(error).__name__, "")


class Question:
    """A question under way.

    Parameters
    ----------
    monitor
        Who is asked.
    service, request
        Name of a service that only looks, and the fields of its request.

    Raises
    ------
    OSError
        When the monitor does not listen.
    """

    def __init__(self, monitor: LocalMonitor, service: str, request: Mapping[str, Any]) -> None:
        self._socket = socket.socket(socket.AF_UNIX)
        try:
            self._socket.settimeout(PATIENCE)
            with _short(monitor.socket) as path:
                self._socket.connect(path)
            self._socket.sendall(json.dumps({"service": service, "request": request}).encode())
            self._socket.shutdown(socket.SHUT_WR)
        except BaseException:
            self._socket.close()
            raise

    def answer(self, timeout: float) -> LocalAnswer:
        """Wait for what it says.

        Raises
        ------
        OSError
            When it does not answer within ``timeout`` seconds, or has ended.
        """
        with self._socket as stream:
            stream.settimeout(timeout)
            text = _read(stream)
        if not text:
            raise ConnectionResetError("it ended")
        return LocalAnswer(**json.loads(text))


def local_monitors(domain: int) -> list[LocalMonitor]:
    """The monitors of one's own robots that listen on this machine, by their names."""
    found = []
    for path in data_dir().glob("*/monitor.*.sock"):
        named = _NAME.fullmatch(path.name)
        if named and int(named[1]) == domain and _listens(path):
            found.append(LocalMonitor(f"/{named[2].replace('.', '/')}", path))
    return sorted(found)


def _listens(path: Path) -> bool:
    """Whether anybody does; a file may be left of a monitor that was killed."""
    with socket.socket(socket.AF_UNIX) as probe:
        probe.settimeout(PATIENCE)
        try:
            with _short(path) as short:
                probe.connect(short)
        except OSError:
            return False
    return True


@contextmanager
def _short(path: Path) -> Iterator[str]:
    """Another way to say a path: that of a socket may have 107 characters."""
    folder = os.open(path.parent, os.O_PATH | os.O_DIRECTORY)
    try:
        yield f"/proc/self/fd/{folder}/{path.name}"
    finally:
        os.close(folder)


def _read(stream: socket.socket, most: int | None = None) -> bytes:
    """All that the other side writes, up to its end."""
    parts: list[bytes] = []
    size = 0
    while part := stream.recv(65_536):
        parts.append(part)
        size += len(part)
        if most is not None and size > most:
            raise OSError("the question is too long")
    return b"".join(parts)
