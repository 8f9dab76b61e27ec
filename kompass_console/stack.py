"""Put together what runs: a recipe's stack, the embedded robot, the console."""

from __future__ import annotations

import difflib
import ipaddress
import logging
import os
import runpy
import secrets
import signal
import socket
import ssl
import sys
import threading
import traceback
import webbrowser
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import typer
from pydantic import ValidationError

from kompass.launch.companions import add_companion
from kompass.launch.environment import EnvironmentProblem
from kompass.launch.processes import run_processes
from kompass.launch.stack import Stack, stacks_go_to
from kompass.printable import log_to_terminal
from kompass.settings import value_text
from kompass.simulation.faults.fault_names import UnknownFault, check_camera
from kompass.simulation.physics.robot_model import (
    RobotModel,
    robot_like,
    robot_model,
    robot_names,
)
from kompass.supervisor.instance_lock import AlreadyRunning
from kompass.supervisor.oversight import StartupError
from kompass.supervisor.process import ProcessSpec, Report
from kompass_console.cli_error import CliError
from kompass_console.domain import look_elsewhere, where
from kompass_console.drills.subject import DrillSubject

if TYPE_CHECKING:
    from kompass_console.webhooks.settings import Webhook

_LOOPBACK = {"0.0.0.0": "127.0.0.1", "::": "::1"}  # of those that listen on every interface


@dataclass(frozen=True)
class Door:
    """How the console is reached: TLS of its own (PEM files), proxies whose word on who comes is
    believed, the hours that an unused session lasts, and whether STOP takes no log-in.

    Raises
    ------
    CliError
        When it cannot work.
    """

    tls_cert: Path | None = None
    tls_key: Path | None = None
    trusted_proxies: Sequence[str] = ()
    idle_hours: float = 12.0
    stop_without_login: bool = True

    def __post_init__(self) -> None:
        for proxy in self.trusted_proxies:
            try:
                ipaddress.ip_address(proxy)
            except ValueError:
                raise CliError(
                    2,
                    f"--trusted-proxy {proxy!r} is not an address; give the proxy's own, "
                    "for example 127.0.0.1",
                ) from None
        if self.tls_cert is None and self.tls_key is None:
            return
        if self.tls_cert is None:
            raise CliError(2, "--tls-key is given without --tls-cert; give both, or neither")
        if self.tls_key is None:
            raise CliError(2, "--tls-cert is given without --tls-key; give both, or neither")
        try:
            context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
            # An empty password: one that is asked for in the terminal would hold up everything.
            context.load_cert_chain(self.tls_cert, self.tls_key, password="")
        except OSError as error:
            no_pair = isinstance(error, ssl.SSLError)
            why = "they are no certificate and key that fit" if no_pair else error.strerror
            raise CliError(
                2,
                f"cannot serve https with --tls-cert {self.tls_cert} and --tls-key "
                f"{self.tls_key}: {why}; give a certificate and its own key, without a password",
            ) from None

    @property
    def scheme(self) -> str:
        return "http" if self.tls_cert is None else "https"


@dataclass
class ConsoleListener:
    """Where the console listens, who may come in, and where the robot is looked for."""

    host: str
    port: int
    open_browser: bool
    robot_name: str
    token: str | None
    ros: str  # domain and network, in words
    door: Door = Door()
    webhooks: Path | None = None  # a file

    def __post_init__(self) -> None:
        if self.token is not None and len(self.token) < 16:
            raise CliError(2, "--token is too short: give at least 16 characters, or leave it out")
        self.drill: DrillSubject | None = None
        self.told = _webhooks(self.webhooks)
        self.accounts = _accounts_file()
        self.tokens = self._tokens(by_name=_anybody_in(self.accounts))
        self.socket = self._listen()
        self.port = self.socket.getsockname()[1]

    def _tokens(self, *, by_name: bool) -> dict[str, str]:
        """What opens the console to whoever has it; where people log in by name, what was given
        only."""
        given = {} if self.token is None else {"operator": self.token}
        if by_name:
            return given
        if self.token is None and not _is_loopback(self.host):
            raise CliError(
                2,
                f"--host {self.host} lets others in, and nobody has said who: add an account with "
                "'kompass-console users add NAME --role engineer', or give a token of your own "
                "with --token or KOMPASS_CONSOLE_TOKEN",
            )
        made = {role: secrets.token_urlsafe(24) for role in ("operator", "viewer", "engineer")}
        return made | given

    def _listen(self) -> socket.socket:
        family = socket.AF_INET6 if ":" in self.host else socket.AF_INET
        listening = socket.socket(family, socket.SOCK_STREAM)
        listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            listening.bind((self.host, self.port))
            listening.listen(128)
        except OSError as error:
            listening.close()
            raise CliError(
                2,
                f"cannot listen on {self.host} port {self.port}: {error.strerror}; "
                "choose another with --port (0 takes a free one) or --host",
            ) from None
        return listening

    def url(self, role: str = "operator", *, here: bool = True) -> str:
        """The address, with the token of a role where there is one.

        Parameters
        ----------
        here
            For a browser on this machine; else for one on the network, where that differs.
        """
        host = self.host
        if host in _LOOPBACK:
            host = _LOOPBACK[host] if here else outward_address(host)
        shown = f"[{host}]" if ":" in host else host
        token = self.tokens.get(role)
        return f"{self.door.scheme}://{shown}:{self.port}/" + (f"#token={token}" if token else "")

    def announce(self) -> None:
        """Print the addresses."""
        if "viewer" in self.tokens:
            ways = (
                f"\n  Console:    {self.url(here=False)}"
                f"\n  To watch:   {self.url('viewer', here=False)}"
                f"\n  Engineer:   {self.url('engineer', here=False)}"
            )
        else:
            ways = f"\n  Console:    {self.url(here=False)}\n  Log in:     by name and password"
        told = "".join(f"\n  Webhook:    {hook.place}" for hook in self.told)
        typer.echo(f"{ways}\n  Robot:      {self.ros}{told}\n")
        if self.door.scheme == "http" and not _is_loopback(self.host):
            typer.echo(
                "  Without TLS, whoever can listen in on this network reads tokens, sessions and "
                "all that the\n  pages show, and can drive with them. Give --tls-cert and "
                "--tls-key, or put a proxy in front.\n"
            )

    def serve(self, report: Report | None = None) -> None:
        """Serve until SIGTERM or SIGINT.

        With a ``report`` it is the robot's own console, and the recordings are at hand. Without
        one it is told in the terminal when no robot is found.
        """
        from kompass_console.server import run_console
        from kompass_console.settings import ConsoleSettings

        settings = ConsoleSettings.model_validate(
            {
                "robot_name": self.robot_name,
                "access_tokens": self.tokens,
                "recordings": None if report is None else _recordings(),
                "drill": self.drill,
                "audit_folder": _audit_folder(self.robot_name),
                "accounts_file": self.accounts,
                "sessions_file": _sessions_file(),
                "idle_limit": self.door.idle_hours * 3600.0,
                "trusted_proxies": tuple(self.door.trusted_proxies),
                "stop_without_login": self.door.stop_without_login,
                "webhooks": self.told,
                "tls_cert": self.door.tls_cert,
                "tls_key": self.door.tls_key,
            }
        )
        log_to_terminal("kompass_console", logging.WARNING)
        if report is not None:
            report("active console")
        if self.open_browser and sys.stdout.isatty() and _has_screen():
            # The socket listens already, so the page waits for the server and not the reverse.
            threading.Thread(target=webbrowser.open, args=(self.url(),), daemon=True).start()
        run_console(self.socket, settings, alone=self._tell_alone if report is None else None)

    def _tell_alone(self) -> None:
        typer.echo(f"No robot is found on {where()} so far; {look_elsewhere()}.", err=True)


def _recordings() -> Path | None:
    """Where this machine's robot keeps its recordings; None where it can keep nothing."""
    from kompass.recorder.places import recordings_folder
    from kompass.store.errors import StoreUnwritable

    try:
        return recordings_folder()
    except StoreUnwritable:  # the stack runs without a store, and has said so
        return None


def _audit_folder(robot: str) -> Path | None:
    """Where this machine keeps what is done to the robot; None where it can keep nothing."""
    from kompass.store.errors import StoreUnwritable
    from kompass.store.paths import ROBOT_NAME
    from kompass_console.audit.files import audit_folder

    try:
        return audit_folder({**os.environ, ROBOT_NAME: robot})
    except StoreUnwritable:  # the console says so
        return None


def _accounts_file() -> Path | None:
    """Where it is kept who may log in by name; None where nothing can be kept."""
    from kompass.store.errors import StoreUnwritable
    from kompass.store.paths import data_dir
    from kompass_console.accounts.accounts import FILE

    try:
        return data_dir() / FILE
    except StoreUnwritable:
        return None


def _anybody_in(file: Path | None) -> bool:
    """Whether there is an account; a file that cannot be read keeps all out, and is told."""
    from kompass_console.accounts.accounts import Accounts, AccountsUnreadable

    try:
        return bool(Accounts(file).all())
    except AccountsUnreadable as error:
        raise CliError(2, str(error)) from None


def _webhooks(file: Path | None) -> tuple[Webhook, ...]:
    """Who is told of what happens; nobody without a file."""
    if file is None:
        return ()
    from kompass_console.webhooks.settings import BadWebhooks, read_webhooks

    try:
        return read_webhooks(file)
    except BadWebhooks as error:
        raise CliError(2, f"--webhooks: {error}") from None


def _sessions_file() -> Path | None:
    """Where it is kept who has logged out; None where nothing can be kept."""
    from kompass.store.errors import StoreUnwritable
    from kompass.store.paths import robot_folder

    try:
        return robot_folder() / "sessions.json"
    except StoreUnwritable:
        return None


def outward_address(host: str) -> str:
    """This machine's address on the network; loopback when it has none.

    Nothing is sent: a UDP socket that is connected knows which interface it would use.
    """
    family = socket.AF_INET6 if host == "::" else socket.AF_INET
    beyond = "2001:db8::1" if host == "::" else "192.0.2.1"  # of documentation, RFC 3849 and 5737
    try:
        with socket.socket(family, socket.SOCK_DGRAM) as probe:
            probe.connect((beyond, 9))
            return str(probe.getsockname()[0])
    except OSError:
        return _LOOPBACK[host]


def _is_loopback(host: str) -> bool:
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


def _has_screen() -> bool:
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def run_recipe(
    recipe: Path,
    console: ConsoleListener,
    sim: str | None,
    faults: Sequence[str] = (),
    robot: str | None = None,
) -> None:
    """Run a recipe with the console beside it, until Ctrl-C.

    ``faults`` are those of the embedded robot (:mod:`kompass.simulation.faults.fault_names`), which
    is the one called ``robot`` (:mod:`kompass.simulation.physics.robot_model`), or one that moves
    as the recipe describes its own.

    Raises
    ------
    CliError
        When it cannot run, with the reason in one line.
    """
    embedded = _Embedded()
    if sim is not None:
        _add_robot(sim, faults, robot, embedded)
    elif robot is not None:
        raise CliError(2, f"--robot {robot} is for the embedded robot; add --sim")
    elif faults:
        raise CliError(2, f"--fault {faults[0]} is for the embedded robot; add --sim")
    try:
        console.drill = DrillSubject.of(recipe, sim)
    except OSError as error:
        raise CliError(2, f"cannot read the recipe {recipe}: {error.strerror}") from None
    add_companion(ProcessSpec("console", console.serve))
    sys.argv = [str(recipe)]
    sys.path.insert(0, str(recipe.resolve().parent))
    brought_up: list[Stack] = []

    def run(stack: Stack) -> None:
        brought_up.append(stack)
        kind = embedded.settle(stack)
        assert console.drill is not None
        console.drill = console.drill.model_copy(update={"robot": kind.name})
        console.announce()
        run_processes(stack)

    try:
        with stacks_go_to(run):
            runpy.run_path(str(recipe), run_name="__main__")
    except (AlreadyRunning, EnvironmentProblem, StartupError) as error:
        raise CliError(1, str(error)) from None
    except CliError:
        raise
    except Exception as error:  # noqa: BLE001 - whatever a recipe raises is told in one line
        raise CliError(3, _where(recipe, error)) from None
    finally:
        console.socket.close()
    if not brought_up:
        raise CliError(3, f"{recipe}: it ended without a stack; call launcher.bringup() at its end")


def _where(recipe: Path, error: Exception) -> str:
    """File, line and message of what a recipe raised."""
    if isinstance(error, SyntaxError):
        return f"{error.filename or recipe}:{error.lineno}: SyntaxError: {error.msg}"
    frames = traceback.extract_tb(error.__traceback__)
    own = [frame for frame in frames if Path(frame.filename).resolve() == recipe.resolve()]
    line = f":{own[-1].lineno}" if own else ""
    text = f"{error}{_meant(error)}"
    if isinstance(error, ValidationError):
        text = "; ".join(
            f"{'.'.join(map(str, item['loc'])) or error.title}{value_text(item['input'])}: "
            f"{item['msg'].removeprefix('Value error, ')}"
            for item in error.errors()
        )
    return f"{recipe}{line}: {type(error).__name__}: {' '.join(text.split())}"


def _meant(error: Exception) -> str:
    """The name that somebody meant who wrote one that an object, or a module, does not have."""
    if not isinstance(error, AttributeError) or "did you mean" in str(error):
        return ""
    names = [name for name in dir(error.obj) if not name.startswith("_")]
    close = difflib.get_close_matches(error.name or "", names, n=1)
    return f"; did you mean '{close[0]}'?" if close else ""


@dataclass
class _Embedded:
    """Which embedded robot drives: the recipe decides, where nobody else did, before any fork.

    Attributes
    ----------
    kind
        None until then.
    faults
        Names of those that are to strike it.
    """

    kind: RobotModel | None = None
    faults: Sequence[str] = ()

    def settle(self, stack: Stack) -> RobotModel:
        """Which it is; raises CliError where it cannot have the faults."""
        if self.kind is None:
            self.kind = robot_like(stack.model_type, stack.heard)
        try:
            for name in self.faults:
                check_camera(name, self.kind)
        except UnknownFault as error:
            raise CliError(2, f"--fault: {error}") from None
        return self.kind


def _add_robot(
    world_name: str, faults: Sequence[str], robot: str | None, embedded: _Embedded
) -> None:
    """The embedded robot and its map, as processes beside the recipe's."""
    from kompass.share import map_path
    from kompass.simulation.faults.fault_names import parse_faults, withholds_map
    from kompass.simulation.worlds.registry import world, world_names

    if world_name not in world_names():
        raise CliError(
            2, f"--sim {world_name}: there is no such world; known are {', '.join(world_names())}"
        )
    if robot is not None and robot not in robot_names():
        raise CliError(
            2, f"--robot {robot}: there is no such robot; known are {', '.join(robot_names())}"
        )
    try:
        orders = parse_faults(faults, world(world_name))
    except UnknownFault as error:
        raise CliError(2, f"--fault: {error}") from None
    embedded.kind = None if robot is None else robot_model(robot)
    embedded.faults = [order.name for order in orders]
    map_file = None if withholds_map(orders) else str(map_path(world_name))

    def simulate(report: Report) -> None:
        from kompass.simulation.node import run_simulator

        report("active simulator")
        assert embedded.kind is not None
        run_simulator(world(world_name), faults=faults, kind=embedded.kind)

    def serve_map(report: Report) -> None:
        from kompass.components import MapServer, MapServerConfig
        from kompass.launch.host import host

        config = MapServerConfig(map_file_path=map_file)
        server = MapServer("map_server", config=config)
        host([server], ["map_server"], report, first_start=False)

    add_companion(ProcessSpec("simulator", simulate, names=["simulator"]))
    add_companion(ProcessSpec("map_server", serve_map, names=["map_server"]))


def run_attached(console: ConsoleListener) -> None:
    """Serve the console alone, in this process, until Ctrl-C."""
    console.announce()
    signal.signal(signal.SIGINT, lambda *_: signal.raise_signal(signal.SIGTERM))
    console.serve()
