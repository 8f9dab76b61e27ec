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
from collections.abc import Awaitable, Callable, Iterator
from typing import Any, TypeVar

import msgspec
import rich
import viser
import viser.infra._infra as viser_infra
from starlette.websockets import WebSocket, WebSocketDisconnect
from websockets.exceptions import ConnectionClosedOK

SUPPORTED_VISER = "1.1.1"

# The page's camera, and pictures the server asked for. Clicks and drags are the page's own
# overlay; everything else (GUI values, uploads, public share tunnels) has no business here.
ALLOWED_MESSAGES = frozenset({"ViewerCameraMessage", "GetRenderResponseMessage"})

_LARGEST_MESSAGE = 8_000_000  # bytes; a rendered picture is the largest legitimate one

_logger = logging.getLogger(__name__)
_T = TypeVar("_T")


class _Connection:
    """The few members of websockets' ServerConnection that viser's handler touches."""

    def __init__(
        self,
        websocket: WebSocket,
        web_loop: asyncio.AbstractEventLoop,
        subprotocol: str,
        view_id: str,
    ) -> None:
        self.subprotocol = subprotocol
        self.view_id = view_id
        self._websocket = websocket
        self._web_loop = web_loop
        self._incoming: asyncio.Queue[bytes | None] = asyncio.Queue()
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
        message = await self._incoming.get()
        if message is None:
            raise ConnectionClosedOK(None, None)
        return message

    async def close(self, code: int = 1000, reason: str = "") -> None:
        if self._closed:
            return
        self.hang_up()
        asyncio.run_coroutine_threadsafe(self._websocket.close(code, reason), self._web_loop)

    def feed(self, message: bytes) -> None:
        self._incoming.put_nowait(message)

    def hang_up(self) -> None:
        self._closed = True
        self._incoming.put_nowait(None)


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
        self._handler: Callable[[_Connection], Awaitable[None]]
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

    async def serve(self, websocket: WebSocket, view_id: str) -> None:
        """Drive one page's scene until it closes. Authenticate before calling this."""
        offered = [p for p in websocket.scope.get("subprotocols", []) if p.startswith("viser-v")]
        if not offered:
            await websocket.close(4400, "This address speaks viser's protocol only.")
            return
        await websocket.accept(subprotocol=offered[0])
        connection = _Connection(websocket, asyncio.get_running_loop(), offered[0], view_id)
        handling = asyncio.run_coroutine_threadsafe(self._handle(connection), self._loop)
        try:
            while True:
                message = await websocket.receive()
                data = message.get("bytes")
                if message["type"] == "websocket.disconnect" or data is None:
                    break
                if len(data) > _LARGEST_MESSAGE:
                    _logger.warning("a page sent %d bytes in one scene message; closed", len(data))
                    break
                if allowed(data):
                    self._loop.call_soon_threadsafe(connection.feed, data)
        finally:
            self._loop.call_soon_threadsafe(connection.hang_up)
            with contextlib.suppress(TimeoutError):
                await asyncio.wait_for(asyncio.wrap_future(handling), 3.0)

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

    async def _handle(self, connection: _Connection) -> None:
        await self._handler(connection)

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


def allowed(data: bytes) -> bool:
    """Whether a scene message from a browser may reach viser."""
    try:
        message = msgspec.msgpack.decode(data)
    except msgspec.DecodeError:
        return False
    return isinstance(message, dict) and message.get("type") in ALLOWED_MESSAGES


def _check_version() -> None:
    if viser.__version__ != SUPPORTED_VISER:
        raise RuntimeError(
            f"viser {viser.__version__} is installed, and the console drives the inside of "
            f"viser {SUPPORTED_VISER} only. Install it: pip install viser=={SUPPORTED_VISER}"
        )
