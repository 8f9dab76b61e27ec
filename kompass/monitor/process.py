"""The monitor's process, from its fork to its end."""

from __future__ import annotations

import ctypes
import gc
import os
import signal
import socket
import sys
import threading
from collections.abc import Callable, Mapping
from functools import partial

import rclpy
from rclpy.signals import SignalHandlerOptions

from kompass.bus.node import Node
from kompass.channel.channels import Channels
from kompass.channel.life import own_life
from kompass.channel.packet import send_packet
from kompass.monitor.incoming import incoming
from kompass.monitor.introspection.catalog import RecipeCatalog
from kompass.monitor.local_socket import LocalSocket
from kompass.monitor.monitor import Memory, Monitor
from kompass.monitor.recording import FlightRecording
from kompass.monitor.settings import MonitorSettings
from kompass.monitor.start import start_from_store
from kompass.rclpy_ext.executor import TaskExecutor
from kompass.rclpy_ext.node import PlainNode
from kompass.recipe.table import RecipeRules
from kompass.store.errors import StoreError
from kompass.store.mission_store import MissionStore
from kompass.store.paths import robot_folder
from kompass.store.place_store import PlaceStore
from kompass.store.timeline_store import TimelineStore
from kompass.store.zone_store import ZoneStore
from kompass.supervisor.heartbeat import send_heartbeat
from kompass.supervisor.process import Report
from kompass.supervisor.usage import UsageMeter

NAME = "monitor"
SPIN_TIMEOUT = 0.1  # s, as of the components' host
# s after which a worker that computes lets the engine in: a fifth of Python's own
SWITCH_INTERVAL = 0.001
_M_MMAP_THRESHOLD, _M_ARENA_MAX = -3, -8  # of mallopt(3)
ARENAS = 2  # heaps of the C library; each thread that comes would be given one of its own
LARGE = 256 << 10  # bytes of what goes back to the kernel as soon as it is freed


def run_monitor(
    recipe: RecipeRules,
    catalog: RecipeCatalog,
    report: Report,
    inbox: int,
    channels: Mapping[str, int],
    supervisor_silent: Callable[[], float],
    namespace: str = "",
    recording: FlightRecording | None = None,
) -> None:
    """Run the monitor in this process until SIGTERM.

    Parameters
    ----------
    recipe
        Rules and functions.
    catalog
        What rules are checked against.
    report
        Tells the supervisor.
    inbox
        File descriptor on which the supervisor tells of processes, a JSON line each.
    channels
        File descriptors of our ends of the channels to components, by their names.
    supervisor_silent
        For how long the supervisor has shown no life [s].
    recording
        The flight recorder; None where there is none.
    """
    ended = threading.Event()
    signal.signal(signal.SIGTERM, lambda *_: ended.set())
    sys.setswitchinterval(SWITCH_INTERVAL)
    _keep_memory_small()
    settings = MonitorSettings.of()
    start, store = start_from_store(recipe.table, settings)
    rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    node = PlainNode(NAME, namespace=namespace or None)
    executor = TaskExecutor()
    executor.add_node(node)
    # Processes that host several components have one channel.
    ends = {each: socket.socket(fileno=each) for each in set(channels.values())}
    senders = {name: partial(send_packet, ends[each]) for name, each in channels.items()}
    monitor = Monitor(
        *(node, executor, recipe, catalog, start, store, settings, report, recording),
        Channels(own_life(), senders),
        supervisor_silent,
        Memory(
            lambda: PlaceStore.open(robot_folder()),
            lambda: MissionStore.open(robot_folder()),
            lambda: ZoneStore.open(robot_folder()),
            lambda: TimelineStore.open(robot_folder()),
        ),
        UsageMeter().look,
    )
    monitor.reach_components(recipe.components)

    def read() -> None:
        for each in incoming(inbox, [*ends.values()]):
            if isinstance(each, str):
                executor.create_task(monitor.process_changed, each)
            else:
                executor.create_task(monitor.component_answered, each)

    # Blocked in a read nearly always; the executor's thread stays the only one that does work.
    threading.Thread(target=read, name="inbox", daemon=True).start()
    # What is there now stays; the collector need not look through it while messages come.
    gc.collect()
    gc.freeze()
    local = _local_socket(node, monitor)
    report(f"active {NAME}")
    try:
        while not ended.is_set():
            executor.spin_on(node, SPIN_TIMEOUT)
            send_heartbeat(NAME)
        # Not after an exception: that is a crash, and counts as one.
        if store is not None:
            store.end_session()
    finally:
        monitor.close()
        if local is not None:
            local.close()
        if store is not None:
            store.close()
        node.destroy_node()
        rclpy.shutdown()


def _keep_memory_small() -> None:
    """Have the C library not keep what reports of back-tests took once, in each thread's heap.

    It makes as many heaps as eight times the processors, and takes what is large for usual once it
    has been freed. Only glibc has this.
    """
    settle = getattr(ctypes.CDLL(None), "mallopt", None)
    if settle is not None:
        settle(_M_ARENA_MAX, ARENAS)
        settle(_M_MMAP_THRESHOLD, LARGE)


def _local_socket(node: Node, monitor: Monitor) -> LocalSocket | None:
    """Where the command line may ask; None where there can be none, and it asks over ROS."""
    domain = int(os.environ.get("ROS_DOMAIN_ID") or 0)
    name = f"{node.get_namespace().rstrip('/')}/{NAME}"
    try:
        return LocalSocket(domain, name, monitor.look)
    except (OSError, StoreError) as error:
        node.get_logger().warning(f"the command line has to ask over ROS, which is slower: {error}")
        return None
