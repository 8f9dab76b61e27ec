"""viser inside this server: no port of its own, and nothing reaches it but what is allowed.

viser opens a TCP listener without login, origin check or TLS, and trusts every message of every
client. Here its listener is replaced, while the server is built, by one that opens no socket; its
connection handler is then driven by websockets which this console has accepted and authenticated.
That leans on viser's private names, so the version is pinned and checked at start-up.

viser runs on an event loop and thread of its own; so do all changes to the scene, which therefore
need no locks. `ViserHub.post` and `ViserHub.run` bring them there.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
import threading
import types
import warnings
from collections.abc import Callable, Coroutine, Iterator
from typing import Any, TypeVar

import rich
import viser
import viser.infra._infra as viser_infra
from starlette.websockets import WebSocket, WebSocketDisconnect
from websockets.exceptions import ConnectionClosedOK

from kompass_console.scene.client_messages import allowed

SUPPORTED_VISER = "1.1.1"

SUBPROTOCOL = f"viser-v{SUPPORTED_VISER}"

_logger = logging.getLogger(__name__)
_T = TypeVar("_T")


class _Connection:
    """The few members of websockets' ServerConnection that viser's handler touches."""

    subprotocol = SUBPROTOCOL

    def __init__(
        self,
        websocket: WebSocket,
        web_loop: asyncio.AbstractEventLoop,
        viser_loop: asyncio.AbstractEventLoop,
        view_id: str,
    ) -> None:
        self.view_id = view_id
        self._websocket = websocket
        self._web_loop = web_loop
        self._viser_loop = viser_loop
        # Only cameras come in, and of those only the newest counts. So nothing queues up between
        # the two loops, however much faster the one is than the other.
        self._newest: bytes | None = None
        self._lock = threading.Lock()
        self._arrived = asyncio.Event()
        self._closed = False

    async def send(self, data: bytes) -> None:
        """Returns when the web server has drained its buffer: that is the back-pressure which
        makes viser skip outdated updates for a slow browser."""
        if self._closed:
            raise ConnectionClosedOK(None, None)
        sending = asyncio.run_coroutine_threadsafe(self._websocket.send_bytes(data), self._web_loop)
        try:
            await asyncio.wrap_future(sending)
        except (WebSocketDisconnect, RuntimeError, OSError) as error:
            self._closed = True
            raise ConnectionClosedOK(None, None) from error

    async def recv(self) -> bytes:
        while not self._closed:
            await self._arrived.wait()
            self._arrived.clear()
            with self._lock:
                message, self._newest = self._newest, None
            if message is not None and not self._closed:
                return message
        raise ConnectionClosedOK(None, None)

    async def close(self, *_: object) -> None:
        """The web server closes the socket when viser's handler has ended."""
        self.hang_up()

    def feed(self, camera: bytes) -> None:
        """Take a camera in the place of the one before. On the web server's loop."""
        with self._lock:
            announced = self._newest is not None
            self._newest = camera
        if not announced:
            self._viser_loop.call_soon_threadsafe(self._arrived.set)

    def hang_up(self) -> None:
        """End viser's handler. On viser's loop."""
        self._closed = True
        self._arrived.set()


class ViserHub:
    """One viser server without a port.

    Parameters
    ----------
    on_connect, on_disconnect
        Take a view's id and its page's client; called on viser's loop.
    """

    def __init__(
        self,
        on_connect: Callable[[str, viser.ClientHandle], None],
        on_disconnect: Callable[[str, viser.ClientHandle], None],
    ) -> None:
        _check_version()
        self._handler: Callable[[_Connection], Coroutine[Any, Any, None]]
        # viser prints its banner through rich's shared console, and nobody else here uses that.
        rich.get_console().quiet = True
        # viser warns when a node of a page that has just gone is updated. A page may go at any
        # moment; its nodes are dropped as soon as viser says so.
        warnings.filterwarnings("ignore", message="Queued a .* on a closed connection")
        with self._without_listener():
            self.server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
        self._loop = self.server.get_event_loop()
        self._views: dict[int, str] = {}

        async def connected(client: viser.ClientHandle) -> None:
            connections: dict[int, Any] = self.server._websock_server._live_connections
            connection = connections.get(client.client_id)
            if connection is not None:
                self._views[client.client_id] = connection.view_id
                on_connect(connection.view_id, client)

        async def disconnected(client: viser.ClientHandle) -> None:
            view_id = self._views.pop(client.client_id, None)
            if view_id is not None:
                on_disconnect(view_id, client)

        self.server.on_client_connect(connected)
        self.server.on_client_disconnect(disconnected)

    async def serve(self, websocket: WebSocket, view_id: str, allows: Callable[[], bool]) -> None:
        """Drive one page's scene until it closes. Accept the socket before, with `SUBPROTOCOL`.

        `allows` is asked for each message; a page that sends more is left.
        """
        connection = _Connection(websocket, asyncio.get_running_loop(), self._loop, view_id)
        handling = asyncio.wrap_future(
            asyncio.run_coroutine_threadsafe(self._handler(connection), self._loop)
        )
        reading = asyncio.create_task(_read(websocket, connection, allows))
        try:
            await asyncio.wait((handling, reading), return_when=asyncio.FIRST_COMPLETED)
        finally:
            reading.cancel()
            self._loop.call_soon_threadsafe(connection.hang_up)
            await asyncio.wait((handling, reading), timeout=3.0)
        if handling.done() and not handling.cancelled() and (error := handling.exception()):
            _logger.error("the scene of a page has ended", exc_info=error)

    def post(self, change: Callable[[], None]) -> None:
        """Run `change` on viser's loop, soon; returns at once."""
        self._loop.call_soon_threadsafe(change)

    async def run(self, change: Callable[[], _T]) -> _T:
        """Run `change` on viser's loop and return what it returns."""

        async def on_loop() -> _T:
            return change()

        return await asyncio.wrap_future(asyncio.run_coroutine_threadsafe(on_loop(), self._loop))

    def stop(self) -> None:
        """End viser's thread."""
        self.server.stop()

    @contextlib.contextmanager
    def _without_listener(self) -> Iterator[None]:
        """While inside, a websocket server that viser builds opens no socket."""
        hub = self
        ready = threading.Event()

        class Listener:
            def __init__(self, handler: Any, *_: object, **__: object) -> None:
                hub._handler = handler

            async def __aenter__(self) -> object:
                ready.set()
                return types.SimpleNamespace(server=types.SimpleNamespace(sockets=[]))

            async def __aexit__(self, *_: object) -> None:
                return None

        module = viser_infra.websockets.asyncio.server
        original = module.serve
        module.serve = Listener
        try:
            yield
            if not ready.wait(5.0):
                raise RuntimeError("viser did not start within 5 s")
        finally:
            module.serve = original


async def _read(websocket: WebSocket, connection: _Connection, allows: Callable[[], bool]) -> None:
    """Hand on what a page may send, until it has gone or sends too much."""
    while True:
        message = await websocket.receive()
        if message["type"] == "websocket.disconnect" or not allows():
            return
        data = message.get("bytes")
        if data is not None and allowed(data):
            connection.feed(data)


def _check_version() -> None:
    if viser.__version__ != SUPPORTED_VISER:
        raise RuntimeError(
            f"viser {viser.__version__} is installed, and the console drives the inside of "
            f"viser {SUPPORTED_VISER} only. Install it: pip install viser=={SUPPORTED_VISER}"
        )
