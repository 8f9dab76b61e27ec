"""A console that ends waits for nobody, and leaves nobody on the line."""

import gc
import socket
from pathlib import Path

import pytest

import kompass_console
from tests.console.conftest import serving
from tests.support.patience import patient

pytestmark = pytest.mark.ros


def test_who_does_not_read_what_was_asked_for_is_hung_up_on(tmp_path: Path, domain: int) -> None:
    assets = Path(kompass_console.__file__).parent / "static" / "assets"
    page = max(assets.iterdir(), key=lambda file: file.stat().st_size)
    with socket.socket() as slow:
        slow.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        slow.settimeout(patient(5))
        with serving(tmp_path / "audit", domain) as own:
            slow.connect(("127.0.0.1", own.port))
            asked = f"GET /assets/{page.name} HTTP/1.1\r\nHost: 127.0.0.1:{own.port}\r\n\r\n"
            slow.sendall(asked.encode())
            assert slow.recv(4, socket.MSG_PEEK) == b"HTTP"
        read = 0
        try:
            while part := slow.recv(65_536):
                read += len(part)
        except ConnectionResetError:
            pass
        assert read < page.stat().st_size
    gc.collect()  # what was left open complains
