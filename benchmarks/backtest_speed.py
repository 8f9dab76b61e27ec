"""How fast a back-test is: ten minutes of made-up messages, replayed with 7 and with 50 rules.

    python benchmarks/backtest_speed.py [MINUTES]

Aim: at least a hundred times as fast as it was recorded, starting a process included.
"""

import math
import resource
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from automatika_ros_sugar.msg import ComponentStatus
from nav_msgs.msg import Odometry
from rclpy.serialization import serialize_message
from sensor_msgs.msg import LaserScan

from kompass.backtest.event_log import Began, to_data
from kompass.recorder.event_log import RecorderEventLog
from kompass.recorder.recorder import Recorder
from kompass.recorder.replay.worker import Worker
from kompass.recorder.shm_queue import ShmQueue
from kompass.rules.schema.table import Table
from tests.recorder.reality import reality_table

RATES = {"scan": 10, "odometry/filtered": 50, "controller/status": 5}
TYPES = {
    "scan": "sensor_msgs/msg/LaserScan",
    "odometry/filtered": "nav_msgs/msg/Odometry",
    "controller/status": "automatika_ros_sugar/msg/ComponentStatus",
}


def message(topic: str, at: float) -> bytes:
    """What a robot says that drives in waves."""
    if topic == "scan":
        made = LaserScan()
        made.ranges = [0.5 + 0.2 * math.sin(at) + 0.01 * (i % 60) for i in range(360)]
    elif topic == "odometry/filtered":
        made = Odometry(child_frame_id="base_link")
        made.header.frame_id = "map"
        made.twist.twist.angular.z = math.sin(at / 3)
        made.twist.twist.linear.x = 0.2
    else:
        made = ComponentStatus()
    return bytes(serialize_message(made))


def record(recordings: Path, table: Table, seconds: float) -> None:
    """Write a recording as the monitor and the recorder do."""
    lane = ShmQueue()
    tape = RecorderEventLog(lane)
    recorder = Recorder(lane, recordings, lambda name: f"/{name}", lambda names: None)
    began = time.monotonic_ns()
    now, wall = began * 1e-9, (began + lane.offset_ns) * 1e-9
    kind, data = to_data(Began(now, wall, "made-up", 1, table))
    tape.event(kind, data, began)
    highest = max(RATES.values())
    for count in range(int(seconds * highest)):
        at = count / highest
        for topic, rate in RATES.items():
            if count % (highest // rate) == 0:
                tape.message(topic, TYPES[topic], message(topic, at), began + int(at * 1e9))
        if count % highest == 0:
            recorder.tick()
            recorder.flush()
    recorder.close()


def processor_time() -> float:
    """Seconds that ended children have used."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def many(table: Table, number: int) -> Table:
    """The same rules again and again, with other thresholds."""
    rules = [
        rule.model_copy(update={"id": f"{rule.id}-{index}"})
        for index in range(number // len(table.rules) + 1)
        for rule in reality_table(0.3 + 0.01 * index).rules
    ]
    return Table(rules=tuple(rules[:number]))


def main() -> None:
    minutes = float(sys.argv[1]) if len(sys.argv) > 1 else 10.0
    table = reality_table(0.45)
    slow = False
    with tempfile.TemporaryDirectory() as folder:
        recordings = Path(folder)
        record(recordings, table, minutes * 60)
        size = sum(path.stat().st_size for path in recordings.rglob("*.mcap"))
        print(f"{minutes:g} min, {size / 1e6:.1f} MB, {sum(RATES.values())} messages/s")
        for proposed in (table, many(table, 50)):
            shares: list[float] = []
            began, used = time.monotonic(), processor_time()
            with Worker(
                kind="backtest",
                table=proposed.model_dump_json(),
                recordings=str(recordings),
                recording="",
                seconds=0.0,
            ) as worker:
                worker.answer(shares.append)
            took = time.monotonic() - began
            factor = minutes * 60 / took
            used = processor_time() - used
            slow = slow or factor < 100
            print(
                f"{len(proposed.rules)} rules: {took:.2f} s = {factor:.0f} x real time "
                f"({used:.2f} s of processor time = {minutes * 60 / used:.0f} x), "
                f"progress told {len(shares)} times"
            )
    sys.exit(1 if slow else 0)


if __name__ == "__main__":
    main()
