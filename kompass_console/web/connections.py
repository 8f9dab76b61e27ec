"""Connections: how many there may be, and how long they may keep the console waiting.

uvicorn bounds neither. Here its two protocols are told by a gate, which knows all connections,
whom to let in; and whoever owes the console something (the rest of a request, or room for what
was sent) for too long is dropped. Dropped means aborted: a connection that is closed politely
stays for as long as its peer does not read.

When there are too many, those who owe something go first, the oldest before the newest: somebody
who presses STOP sends a whole request at once, and is answered whoever else holds connections open.
"""

from __future__ import annotations

import asyncio
import select
import time
from collections import Counter
from collections.abc import Callable, Iterable
from typing import Any

import h11
from uvicorn.config import Config
from uvicorn.protocols.http.h11_impl import H11Protocol
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol
from uvicorn.server import ServerState
from websockets.frames import Frame
from websockets.http11 import Request

from kompass_console.settings import ConnectionLimits
from kompass_console.web.addresses import one_client
from kompass_console.web.compression import LargeMessagesFactory

_MOST_FRAMES = 64  # of one message; each costs memory, even an empty one
_MOST_UNREAD = 65_536  # bytes of answers to pings
_FULL = (
    b"HTTP/1.1 503 Service Unavailable\r\nContent-Type: application/json\r\nConnection: close\r\n"
    b"Retry-After: 2\r\nContent-Length: 98\r\n\r\n"
    b'{"detail":{"title":"Too many connections are open.","remedy":"Wait a few seconds and '
    b'try again."}}'
)


class Slot:
    """One connection, as the gate sees it.

    Attributes
    ----------
    address
        What it is counted by.
    deadline
        Monotonic time by which the rest of a request must be there; None when nothing is owed.
    waiting
        Whether the other side has the next move, so that nothing is lost if it is dropped.
    served
        Whether a whole request has come over it.
    """

    def __init__(self, transport: asyncio.Transport, address: str) -> None:
        self.transport = transport
        self.address = address
        self.deadline: float | None = None
        self.waiting = True
        self.served = False
        self._unread_since: float | None = None

    def taken(self) -> None:
        """The other side has taken some of what was sent."""
        self._unread_since = None

    def late(self, now: float, unread_time: float) -> bool:
        """Whether this connection has kept the console waiting for too long."""
        if self.transport.get_write_buffer_size() == 0:
            self._unread_since = None
        elif self._unread_since is None:
            self._unread_since = now
        unread = self._unread_since
        if unread is not None and now - unread > unread_time:
            return True
        return self.deadline is not None and now > self.deadline


class ConnectionGate:
    """All connections of a console; lives on the web server's loop.

    Parameters
    ----------
    proxies
        Addresses through which many people come; not bounded one by one.
    """

    def __init__(self, limits: ConnectionLimits, proxies: Iterable[str] = ()) -> None:
        self.limits = limits
        self._proxies = {one_client(proxy) for proxy in proxies}
        self._slots: dict[asyncio.Transport, Slot] = {}

    def __len__(self) -> int:
        return len(self._slots)

    def enter(self, transport: asyncio.Transport) -> Slot | None:
        """A slot for a new connection; None when nobody could be dropped for it."""
        peer = transport.get_extra_info("peername")
        address = one_client(str(peer[0])) if peer else ""
        same = [slot for slot in self._slots.values() if slot.address == address]
        full = len(self._slots) >= self.limits.total
        if address not in self._proxies and len(same) >= self.limits.of_one_address:
            if not self._make_room(same):
                return None
        elif full and not self._make_room(self._of_the_busiest()):
            return None
        slot = self._slots[transport] = Slot(transport, address)
        slot.deadline = time.monotonic() + self.limits.header_time
        return slot

    def leave(self, transport: asyncio.Transport) -> None:
        """A connection has ended."""
        self._slots.pop(transport, None)

    def slot(self, transport: asyncio.Transport) -> Slot:
        """The slot of a connection that became a websocket."""
        return self._slots[transport]

    def sweep(self) -> None:
        """Drop those who have kept the console waiting for too long."""
        now = time.monotonic()
        for slot in list(self._slots.values()):
            if slot.late(now, self.limits.unread_time):
                self._drop(slot)

    def _of_the_busiest(self) -> list[Slot]:
        """Slots that could be given up, those of the address with the most of them first."""
        counts = Counter(slot.address for slot in self._slots.values())
        return sorted(self._slots.values(), key=lambda slot: -counts[slot.address])

    def _make_room(self, among: list[Slot]) -> bool:
        waiting = [slot for slot in among if slot.waiting]
        if not waiting:
            return False
        # Of many who come at once one has sent its request already, though nobody has read it yet.
        sent = _with_unread_input(waiting)
        self._drop(min(waiting, key=lambda slot: (slot in sent, slot.served)))
        return True

    def _drop(self, slot: Slot) -> None:
        self._slots.pop(slot.transport, None)
        slot.transport.abort()


def _with_unread_input(slots: list[Slot]) -> set[Slot]:
    """Those of whom the kernel holds something that was not read yet."""
    files = {slot.transport.get_extra_info("socket").fileno(): slot for slot in slots}
    looking = select.poll()
    for file in files:
        if file >= 0:
            looking.register(file, select.POLLIN)
    return {files[file] for file, _ in looking.poll(0)}


class GatedState(ServerState):
    """What uvicorn's protocols share, and the gate."""

    def __init__(
        self,
        gate: ConnectionGate,
        largest_message: Callable[[str], int],
        compressed: Callable[[str], bool],
    ) -> None:
        super().__init__()
        self.gate = gate
        self.largest_message = largest_message
        self.compressed = compressed


class GatedHttp(H11Protocol):
    """uvicorn's HTTP, with the gate's word on who comes in and when somebody is too slow."""

    def __init__(
        self,
        config: Config,
        server_state: GatedState,
        app_state: dict[str, Any],
        _loop: asyncio.AbstractEventLoop | None = None,
    ) -> None:
        super().__init__(config, server_state, app_state, _loop)
        self._gate = server_state.gate
        self._slot: Slot | None = None
        self._owed: str | None = "headers"

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        self._slot = self._gate.enter(transport)
        if self._slot is None:
            transport.write(_FULL)
            transport.close()
            return
        super().connection_made(transport)

    def connection_lost(self, exc: Exception | None) -> None:
        if self._slot is not None:
            self._gate.leave(self._slot.transport)
            super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        if self._slot is not None:
            super().data_received(data)

    def handle_events(self) -> None:
        super().handle_events()
        self._watch()

    def on_response_complete(self) -> None:
        super().on_response_complete()
        self._watch()

    def pause_writing(self) -> None:
        super().pause_writing()
        self._watch()

    def resume_writing(self) -> None:
        super().resume_writing()
        if self._slot is not None:
            self._slot.taken()
        self._watch()

    def _watch(self) -> None:
        """Set the deadline of what is owed now: headers that have begun, or a body."""
        slot = self._slot
        if slot is None or isinstance(self.transport.get_protocol(), WebSocketsSansIOProtocol):
            return  # a websocket by now, with deadlines of its own
        state = self.conn.their_state
        owed: str | None = None
        if state is h11.IDLE and (not slot.served or self.conn.trailing_data[0]):
            owed = "headers"
        elif state is h11.SEND_BODY:
            owed = "body"
        if state not in (h11.IDLE, h11.SEND_BODY):
            slot.served = True
        if owed != self._owed:
            limits = self._gate.limits
            spare = limits.header_time if owed == "headers" else limits.body_time
            slot.deadline = None if owed is None else time.monotonic() + spare
            self._owed = owed
        slot.waiting = state in (h11.IDLE, h11.SEND_BODY) or self.flow.write_paused


class GatedWebSocket(WebSocketsSansIOProtocol):
    """uvicorn's websocket, with a size of messages for each path, large ones packed where told so,
    and the gate's deadlines."""

    def __init__(
        self,
        config: Config,
        server_state: GatedState,
        app_state: dict[str, Any],
        _loop: asyncio.AbstractEventLoop | None = None,
    ) -> None:
        super().__init__(config, server_state, app_state, _loop)
        self._gate = server_state.gate
        self._largest_message = server_state.largest_message
        self._compressed = server_state.compressed
        self._slot: Slot | None = None

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        assert isinstance(transport, asyncio.Transport)
        self._slot = self._gate.slot(transport)
        self._slot.deadline = time.monotonic() + self._gate.limits.header_time
        super().connection_made(transport)

    def connection_lost(self, exc: Exception | None) -> None:
        self._gate.leave(self.transport)
        super().connection_lost(exc)

    def handle_connect(self, event: Request) -> None:
        if not all(
            value.isascii()
            for name, value in event.headers.raw_items()
            if name.lower().startswith("sec-websocket-")
        ):
            self._refuse(event, "A header Sec-WebSocket-… has characters other than ASCII.\n")
            return
        # Before any frame is read: a larger one is refused by its header, and never buffered.
        path = event.path.partition("?")[0]
        self.conn.max_message_size = self._largest_message(path)
        if self._compressed(path):
            self.conn.available_extensions = [LargeMessagesFactory()]
        super().handle_connect(event)

    def _refuse(self, event: Request, text: str) -> None:
        """Answer 400 to who asks for a websocket, and hang up."""
        self.request, self.response = event, self.conn.reject(400, text)
        self.handshake_initiated = self.handshake_complete = self.close_sent = True
        self.conn.send_response(self.response)
        self.transport.write(b"".join(self.conn.data_to_send()))
        self.transport.close()

    def start_keepalive(self) -> None:
        assert self._slot is not None
        self._slot.deadline, self._slot.waiting = None, False
        super().start_keepalive()

    def handle_cont(self, event: Frame) -> None:
        if len(self.frames) >= _MOST_FRAMES:
            self.transport.abort()
            return
        super().handle_cont(event)

    def handle_ping(self) -> None:
        if self.transport.get_write_buffer_size() > _MOST_UNREAD:
            self.transport.abort()  # it asks, and does not take the answers
            return
        super().handle_ping()

    def resume_writing(self) -> None:
        super().resume_writing()
        if self._slot is not None:
            self._slot.taken()
