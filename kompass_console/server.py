"""Runs a console on a socket until it is told to stop."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import signal
import socket
import sys
import threading
import time
from collections.abc import Callable, Coroutine, Iterator, Sequence
from typing import Any

import uvicorn
from fastapi import FastAPI

from kompass.supervisor.heartbeat import send_heartbeat
from kompass_console.accounts.accounts import Accounts
from kompass_console.api.app import create_app
from kompass_console.api.sockets import compressed, largest_message
from kompass_console.audit.log import AuditLog
from kompass_console.drills.drills import Drills
from kompass_console.link.goal_check import GoalChecker
from kompass_console.link.link import RosLink
from kompass_console.link.localisation import Localisation
from kompass_console.recordings import Recordings
from kompass_console.scene.scene import Scene
from kompass_console.schema.world import WorldModel
from kompass_console.settings import ConsoleSettings
from kompass_console.web.audit import AuditTrail
from kompass_console.web.auth import Authenticator, LoginLimiter
from kompass_console.web.connections import (
    ConnectionGate,
    GatedHttp,
    GatedState,
    GatedWebSocket,
)
from kompass_console.web.console import Console
from kompass_console.web.control import Control
from kompass_console.web.hands import Hands
from kompass_console.web.joint_call import JointCall
from kompass_console.web.open_sockets import OpenSockets
from kompass_console.web.rules_feed import RulesFeed
from kompass_console.web.session_records import SessionRecords
from kompass_console.web.state_feed import StateFeed
from kompass_console.web.views import ViewRegistry
from kompass_console.webhooks.sender import Webhooks

_logger = logging.getLogger(__name__)

# Unsent bytes the kernel may hold per connection. More would be a queue of old pictures in front
# of a slow tablet; what waits here instead is replaced by what is newer.
_NOT_SENT_LOW_WATER = 16_384
MEET = 5.0  # s
_BETWEEN_OPEN_STOPS = 0.2  # s; nobody who floods us floods the robot

# s after which a thread that computes lets STOP in: a fifth of Python's own
_SWITCH_INTERVAL = 0.001
_TICKS_OF_SWEEP = 3  # of 0.1 s, between two looks for who keeps us waiting


def run_console(
    sock: socket.socket,
    settings: ConsoleSettings,
    *,
    stop: threading.Event | None = None,
    alone: Callable[[], None] | None = None,
) -> None:
    """Serve the console on a bound TCP socket until SIGTERM, SIGINT or `stop`.

    ``alone`` is called once if nobody else was met over ROS within `MEET` seconds.

    Call it in a process of its own (forked before rclpy.init) or in the main process. It returns
    within a second of being told to; nobody is waited for who still has the page open.

    Raises
    ------
    RuntimeError
        When the installed viser is another version than the one it drives.
    """
    sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NOTSENT_LOWAT, _NOT_SENT_LOW_WATER)
    # asyncio does so itself only for sockets that were made with their protocol named. Without it
    # the second half of every small answer waits 40 ms for the browser's acknowledgement.
    sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    sys.setswitchinterval(_SWITCH_INTERVAL)
    with running_console(settings) as console:
        beside: list[Coroutine[Any, Any, None]] = []
        if alone is not None:
            beside.append(_look_round(console.link, alone))
        asyncio.run(_serve(sock, create_app(console), settings, stop, beside))


@contextlib.contextmanager
def running_console(settings: ConsoleSettings) -> Iterator[Console]:
    """A console's ROS link and scene, without its web server."""
    world = WorldModel()
    feed = StateFeed()
    rules_feed = RulesFeed()
    views = ViewRegistry(settings.theme)
    auth = Authenticator(
        settings.access_tokens,
        SessionRecords(settings.sessions_file, time.time()),
        Accounts(settings.accounts_file),
        lifetime=settings.session_lifetime,
        idle_limit=settings.idle_limit,
    )
    with contextlib.ExitStack() as closing:
        scene = Scene(world, views.find)
        closing.callback(scene.stop)
        audit_log = AuditLog(settings.audit_folder)
        closing.callback(audit_log.close)
        link = RosLink(settings, world, feed.changed, rules_feed.changed)
        closing.callback(link.stop)
        localisation = Localisation(world)
        localisation.start()
        closing.callback(localisation.stop)
        drills = Drills(settings.drill)
        closing.callback(drills.close)
        audit = AuditTrail(audit_log, link.notes.note)
        sockets, hands = OpenSockets(auth, settings.limits), Hands()
        yield Console(
            settings=settings,
            auth=auth,
            limiter=LoginLimiter(),
            passwords=asyncio.Semaphore(1),
            open_stop=JointCall(_BETWEEN_OPEN_STOPS),
            audit=audit,
            world=world,
            link=link,
            checker=GoalChecker(link, world),
            localisation=localisation,
            sockets=sockets,
            hands=hands,
            control=Control(sockets, hands, audit, feed.changed),
            views=views,
            scene=scene,
            feed=feed,
            rules_feed=rules_feed,
            recordings=Recordings(folder) if (folder := settings.recordings) else None,
            drills=drills,
            webhooks=Webhooks(settings.webhooks, settings.robot_name),
        )


async def _serve(
    sock: socket.socket,
    app: FastAPI,
    settings: ConsoleSettings,
    stop: threading.Event | None,
    beside: Sequence[Coroutine[Any, Any, None]],
) -> None:
    config = uvicorn.Config(
        app,
        log_level="warning",
        access_log=False,
        http=GatedHttp,
        ws=GatedWebSocket,
        ws_per_message_deflate=False,  # GatedWebSocket has its own
        ws_ping_interval=5.0,
        ws_ping_timeout=10.0,
        server_header=False,
        proxy_headers=bool(settings.trusted_proxies),
        forwarded_allow_ips=list(settings.trusted_proxies),
        timeout_keep_alive=int(settings.limits.keep_alive),
        timeout_graceful_shutdown=1,  # s; pages are told, and not waited for any longer
        ssl_certfile=settings.tls_cert,
        ssl_keyfile=settings.tls_key,
        lifespan="on",
    )
    gate = ConnectionGate(settings.limits, settings.trusted_proxies)
    server = _Server(config, gate)
    loop = asyncio.get_running_loop()
    if threading.current_thread() is threading.main_thread():
        for number in (signal.SIGTERM, signal.SIGINT):
            loop.add_signal_handler(number, server.end)
    watching = [asyncio.create_task(one) for one in beside]
    if stop is not None:
        watching.append(asyncio.create_task(_watch(stop, server)))
    try:
        await server.serve(sockets=[sock])
    finally:
        for task in watching:
            task.cancel()


class _Server(uvicorn.Server):
    """uvicorn with a gate, that leaves signals to whoever started it."""

    def __init__(self, config: uvicorn.Config, gate: ConnectionGate) -> None:
        super().__init__(config)
        self.server_state = GatedState(gate, largest_message, compressed)
        self._gate = gate

    @contextlib.contextmanager
    def capture_signals(self) -> Iterator[None]:
        yield

    def end(self) -> None:
        self.should_exit = True

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """As uvicorn's, with a bound to the time that a TLS handshake may take."""
        await super().startup([])
        if self.should_exit:
            return
        loop = asyncio.get_running_loop()
        tls = self.config.ssl
        for sock in sockets or []:
            serving = await loop.create_server(
                self._protocol,
                sock=sock,
                ssl=tls,
                ssl_handshake_timeout=self._gate.limits.header_time if tls else None,
                backlog=self.config.backlog,
            )
            self.servers.append(serving)

    def _protocol(self) -> GatedHttp:
        assert isinstance(self.server_state, GatedState)
        return GatedHttp(self.config, self.server_state, self.lifespan.state)

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """As uvicorn's, and hangs up on whoever did not read what they had asked for until then."""
        await super().shutdown(sockets)
        for connection in list(self.server_state.connections):
            connection.transport.abort()
        await asyncio.sleep(0.01)  # the loop closes what is aborted in its next turns

    async def on_tick(self, counter: int) -> bool:
        # Ten times a second; a loop that hangs is found by the supervisor.
        send_heartbeat("console")
        if counter % _TICKS_OF_SWEEP == 0:
            self._gate.sweep()
        return await super().on_tick(counter)


async def _watch(stop: threading.Event, server: _Server) -> None:
    while not stop.is_set():
        await asyncio.sleep(0.05)
    server.end()


async def _look_round(link: RosLink, alone: Callable[[], None]) -> None:
    await asyncio.sleep(MEET)
    if not link.meets_somebody:
        alone()
