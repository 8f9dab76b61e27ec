"""Large messages over a websocket, compressed (permessage-deflate, RFC 7692); small ones as they
are.

Compression of everything costs a console with twenty pages more time than it saves: what moves is
small and sent many times a second. A map's walls are half a megabyte once, and a tenth of it when
packed.
"""

from __future__ import annotations

from collections.abc import Sequence

from websockets.exceptions import NegotiationError
from websockets.extensions import Extension
from websockets.extensions.permessage_deflate import (
    PerMessageDeflate,
    ServerPerMessageDeflateFactory,
)
from websockets.frames import CTRL_OPCODES, Frame
from websockets.typing import ExtensionParameter

_LARGE = 16_384  # bytes
_LEVEL = 5  # of zlib: more take twice the time for nothing
_SMALLEST_WINDOW = 9  # bits; zlib packs with no smaller one, which RFC 7692 knows of


class LargeMessages(PerMessageDeflate):  # type: ignore[misc]
    """Packs messages of many bytes that are sent; unpacks whatever comes packed."""

    def encode(self, frame: Frame) -> Frame:
        if frame.opcode in CTRL_OPCODES or len(frame.data) < _LARGE:
            return frame
        return super().encode(frame)


class LargeMessagesFactory(ServerPerMessageDeflateFactory):  # type: ignore[misc]
    """Agrees on compression with a page that offers it. Nothing is kept from one message to the
    next, so a connection costs no memory while it is silent."""

    def __init__(self) -> None:
        super().__init__(
            server_no_context_takeover=True,
            client_no_context_takeover=True,
            compress_settings={"level": _LEVEL},
        )

    def process_request_params(
        self, params: Sequence[ExtensionParameter], accepted_extensions: Sequence[Extension]
    ) -> tuple[list[ExtensionParameter], PerMessageDeflate]:
        agreed, deflate = super().process_request_params(params, accepted_extensions)
        if deflate.local_max_window_bits < _SMALLEST_WINDOW:
            raise NegotiationError("a window of 256 bytes")
        return agreed, LargeMessages(
            deflate.remote_no_context_takeover,
            deflate.local_no_context_takeover,
            deflate.remote_max_window_bits,
            deflate.local_max_window_bits,
            deflate.compress_settings,
        )
