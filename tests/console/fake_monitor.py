"""The real monitor with its services, table manager and store, on a robot that has nothing else.

No component, no supervisor and no flight recorder are there: what a process is doing, what a
recording holds and what a back-test finds is made up here, and so is a disk that is full. Run it
with `python -m tests.console.fake_monitor FOLDER`, where its store is to be.
"""

from __future__ import annotations

import json
import signal
import sys
import threading
from pathlib import Path
from typing import Any

import rclpy
from kompass_interfaces.action import BacktestRules
from rclpy.action import ActionServer, CancelResponse
from rclpy.executors import Executor, MultiThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

from kompass.access.gatekeeper import Gatekeeper
from kompass.backtest.report import BacktestReport
from kompass.monitor.introspection.catalog import RecipeCatalog
from kompass.monitor.monitor import Memory, Monitor
from kompass.monitor.settings import MonitorSettings
from kompass.monitor.start import Start
from kompass.rclpy_ext.executor import TaskExecutor
from kompass.rclpy_ext.node import PlainNode
from kompass.recipe.table import RecipeRules
from kompass.rulebook.schema.journal import FiringRecord
from kompass.rulebook.schema.revision import Revision
from kompass.rules.schema.actions import Log, RaiseAlarm
from kompass.rules.schema.conditions import Absent, Compare
from kompass.rules.schema.events import Event
from kompass.rules.schema.signals import Signal
from kompass.rules.schema.table import Rule, Table
from kompass.store.errors import StoreUnwritable
from kompass.store.mission_store import MissionStore
from kompass.store.place_store import PlaceStore
from kompass.store.store import RuleStore
from kompass.store.timeline_store import TimelineStore
from kompass.store.zone_store import ZoneStore

NEAR = Rule(
    id="near",
    name="Something is near",
    source="recipe",
    event=Event(
        condition=Compare(
            signal=Signal(
                topic="scan", type="sensor_msgs/msg/LaserScan", path=("ranges",), aggregate="min"
            ),
            operator="<",
            value=0.01,
        )
    ),
    actions=(Log(text="near"),),
)
# Nobody ever says anything there: it fires once, and once more after each reset.
SILENT = Rule(
    id="silent",
    name="The battery says nothing",
    source="recipe",
    protected=True,
    event=Event(
        condition=Absent(
            signal=Signal(topic="battery_left", type="std_msgs/msg/Float32"), seconds=0.05
        ),
        trigger="edge",
    ),
    actions=(RaiseAlarm(alarm="low-battery", text="Battery at 9 %"),),
)
TABLE = Table(rules=(NEAR, SILENT))
DISK_FULL = "disk full"  # the reason with which applying fails
PLANNER = {
    "name": "planner",
    "nodes": ["planner"],
    "state": "busy",
    "pid": 77,
    "restarts": 2,
    "reason": "killed",
}


class FullStore(RuleStore):
    """A store whose disk is full for who gives that as the reason."""

    def append(self, table: Table, **more: Any) -> Revision:
        if more.get("reason") == DISK_FULL:
            raise StoreUnwritable("the disk is full")
        return super().append(table, **more)


class Backtests:
    """The action server of back-tests, whose recordings have names that say how one ends."""

    def __init__(self) -> None:
        self._ending = threading.Event()
        self._node = rclpy.create_node("backtests")
        self._server = ActionServer(
            self._node,
            BacktestRules,
            "/monitor/backtest_rules",
            self._execute,
            cancel_callback=lambda _: CancelResponse.ACCEPT,
        )
        self._executor = MultiThreadedExecutor(4)
        self._executor.add_node(self._node)
        self._thread = threading.Thread(target=self._executor.spin)
        self._thread.start()

    def close(self) -> None:
        self._ending.set()
        self._executor.shutdown(2.0)
        self._thread.join(2.0)
        self._server.destroy()
        self._node.destroy_node()

    def _execute(self, handle: Any) -> BacktestRules.Result:
        handle.publish_feedback(BacktestRules.Feedback(progress=0.5, text="half"))
        if handle.request.recording == "broken":
            handle.abort()
            return BacktestRules.Result(message="it is no recording")
        while handle.request.recording == "endless":
            if handle.is_cancel_requested:
                handle.canceled()
                return BacktestRules.Result()
            if self._ending.wait(0.02):
                handle.abort()
                return BacktestRules.Result()
        report = BacktestReport(
            start=0.0,
            end=1.0,
            messages=1,
            seconds=0.1,
            firings=(),
            tallies=(),
            same=0,
            new=0,
            gone=0,
        )
        handle.succeed()
        return BacktestRules.Result(success=True, answer=report.model_dump_json())


class NoFiles:
    """A flight recorder that keeps nothing and says where it is."""

    event_log = None

    def __init__(self) -> None:
        self._backtests = Backtests()

    def start(
        self, node: Node, executor: Executor, store: RuleStore | None, gatekeeper: Gatekeeper
    ) -> None:
        """Back-tests are offered already."""

    def fired(self, entry: FiringRecord) -> None:
        """Nothing is kept."""

    def save(self, seconds: float, name: str, until_ns: int) -> str:
        if name == "taken":
            raise FileExistsError("there is a recording 'taken' already")
        return f"/recordings/{name}.mcap"

    def close(self) -> None:
        self._backtests.close()


def run(folder: Path, ending: threading.Event) -> None:
    """Run a monitor that has its store in a folder."""
    recipe = RecipeRules(TABLE)
    node, executor = PlainNode("monitor"), TaskExecutor()
    executor.add_node(node)
    with FullStore.open(folder) as store:
        boot = store.begin_session(TABLE, epoch="fake", stack="fake")
        assert boot.revision is not None
        monitor = Monitor(
            node,
            executor,
            recipe,
            RecipeCatalog([], recipe),
            Start(boot.table, boot.revision, "fake"),
            store,
            MonitorSettings(robot="fake"),
            ask=lambda _: None,
            recording=NoFiles(),
            memory=Memory(
                lambda: PlaceStore.open(folder),
                lambda: MissionStore.open(folder),
                lambda: ZoneStore.open(folder),
                lambda: TimelineStore.open(folder),
            ),
        )
        monitor.process_changed(json.dumps(PLANNER))
        while not ending.is_set():
            executor.spin_once(timeout_sec=0.1)
        monitor.close()
    node.destroy_node()


def main() -> None:
    """Run until SIGTERM."""
    ending = threading.Event()
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, lambda *_: ending.set())
    rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    run(Path(sys.argv[1]), ending)
    rclpy.shutdown()


if __name__ == "__main__":
    main()
