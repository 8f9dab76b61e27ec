"""One request to one address: signed, bounded in time, and never led elsewhere."""

from __future__ import annotations

import asyncio
import hashlib
import hmac
import socket
import ssl
import time

import h11

from kompass_console.version import VERSION
from kompass_console.webhooks.settings import Webhook, may_be_told

TIMEOUT = 10.0  # s for all of it: the name, the connection, TLS, the answer

_PORTS = {"http": 80, "https": 443}
_READ = 4096  # bytes at once
_LONGEST_HEAD = 16_384  # bytes of an answer's head; of its body nothing is read


class NotTaken(Exception):
    """A notice did not arrive; the message is the end of a sentence.

    `again` says whether it may be taken another time.
    """

    def __init__(self, why: str, *, again: bool = True) -> None:
        super().__init__(why)
        self.again = again


def signature(secret: str, timestamp: str, body: bytes) -> str:
    """HMAC-SHA256 of the time and the body, as it stands in `Kompass-Signature`."""
    signed = hmac.digest(secret.encode(), timestamp.encode() + b"." + body, hashlib.sha256)
    return f"sha256={signed.hex()}"


async def post(hook: Webhook, body: bytes) -> None:
    """Send a body, and wait until it was taken.

    Redirections are answers that do not take it: where a notice goes was decided by whoever wrote
    the file. Proxies of the environment are not asked.

    Raises
    ------
    NotTaken
        When that is not so within `TIMEOUT`.
    """
    try:
        async with asyncio.timeout(TIMEOUT):
            status = await _ask(hook, body)
    except TimeoutError:
        raise NotTaken(f"no answer came within {TIMEOUT:.0f} s") from None
    except ssl.SSLCertVerificationError as error:
        raise NotTaken(f"its certificate is not valid: {error.verify_message}") from None
    except OSError as error:
        raise NotTaken(f"it cannot be reached: {error.strerror or error}") from None
    except h11.RemoteProtocolError as error:
        raise NotTaken(f"what it answers is no HTTP: {error}") from None
    if not 200 <= status < 300:
        again = status >= 500 or status in (408, 425, 429)
        raise NotTaken(f"it answers {status}", again=again)


async def _ask(hook: Webhook, body: bytes) -> int:
    parts = hook.parts
    over_tls = parts.scheme == "https"
    host, port = parts.hostname or "", parts.port or _PORTS[parts.scheme]
    address = await _address(host, port, over_tls=over_tls)
    # All certificates that this machine believes are read for it.
    tls = await asyncio.to_thread(ssl.create_default_context) if over_tls else None
    reader, writer = await asyncio.open_connection(
        address, port, ssl=tls, server_hostname=host if over_tls else None, limit=_READ
    )
    try:
        connection = h11.Connection(h11.CLIENT, max_incomplete_event_size=_LONGEST_HEAD)
        timestamp = str(int(time.time()))
        headers = [
            ("Host", parts.netloc),
            ("User-Agent", f"kompass-console/{VERSION}"),
            ("Content-Type", "application/json"),
            ("Content-Length", str(len(body))),
            ("Connection", "close"),
            ("Kompass-Timestamp", timestamp),
        ]
        if hook.secret is not None:
            headers.append(("Kompass-Signature", signature(hook.secret, timestamp, body)))
        target = (parts.path or "/") + (f"?{parts.query}" if parts.query else "")
        asked = h11.Request(method="POST", target=target, headers=headers)
        for part in (asked, h11.Data(data=body), h11.EndOfMessage()):
            writer.write(connection.send(part) or b"")
        await writer.drain()
        while not isinstance(answer := connection.next_event(), h11.Response):
            if answer is h11.NEED_DATA:
                connection.receive_data(await reader.read(_READ))
        return int(answer.status_code)
    finally:
        # A polite end of TLS waits for the other side, and the answer would come too late for it.
        writer.transport.abort()


async def _address(host: str, port: int, *, over_tls: bool) -> str:
    """What a name means now, if a notice may go there: looked up once, and then gone to."""
    loop = asyncio.get_running_loop()
    try:
        found = await loop.getaddrinfo(host, port, type=socket.SOCK_STREAM)
    except socket.gaierror as error:
        raise NotTaken(f"its name is not known: {error.strerror}") from None
    for *_, place in found:
        if may_be_told(str(place[0]), over_tls=over_tls):
            return str(place[0])
    why = "it is no address that notices go to"
    if not over_tls:
        why = "http is for this machine and private networks; use https"
    raise NotTaken(why, again=False)
