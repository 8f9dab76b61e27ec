"""The rules of `docs/rules-by-example.md` fire when the text below them says."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from automatika_ros_sugar.msg import ComponentStatus
from geometry_msgs.msg import PointStamped
from kompass_interfaces.msg import GoalHindrance
from nav_msgs.msg import Odometry
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import BatteryState, LaserScan, Temperature
from std_msgs.msg import Bool, String

from kompass.message_types import ros_class
from kompass.rclpy_ext.messages import fill
from kompass.rules.engine.compiled_table import compile_table
from kompass.rules.engine.firing import Firing, RunEnded, Sample, Tick
from kompass.rules.engine.step import initial_state, step
from kompass.rules.schema.actions import arguments_of
from kompass.rules.schema.arguments import expand, resolve
from kompass.rules.schema.conditions import leaves
from kompass.rules.schema.table import Rule, Table
from tests.docs.blocks import ROOT, blocks_of
from tests.docs.test_docs import is_rules, table_of

PAGE = ROOT / "docs" / "rules-by-example.md"
Said = tuple[float, str, Any]  # s, topic, message; the topic is empty where only time passes


@pytest.fixture(scope="module")
def rules(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Rule]:
    folder: Path = tmp_path_factory.mktemp("rules")
    blocks = [b for b in blocks_of(PAGE) if b.language == "yaml" and is_rules(b)]
    return {rule.id: rule for block in blocks for rule in table_of(block, folder).rules}


def firings(rule: Rule, said: list[Said]) -> list[float]:
    """When a rule fires, its actions taking no time; also by time alone, to a tenth of a second."""
    table = compile_table(Table(rules=(rule,)))
    state = initial_state(table, 0.0)
    fired: list[float] = []
    inputs: list[tuple[float, Any]] = [
        (time, Sample(topic, message) if topic else Tick()) for time, topic, message in said
    ]
    last = max(time for time, _ in inputs)
    inputs += [(0.1 * index, Tick()) for index in range(int(last * 10) + 1)]
    for time, each in sorted(inputs, key=lambda one: one[0]):
        state, outputs = step(table, state, each, time)
        for output in outputs:
            if isinstance(output, Firing):
                fired.append(round(time, 1))
                state, _ = step(table, state, RunEnded(output.rule_id, output.run_id), time)
    return fired


def hindrances(*said: tuple[float, str, float]) -> list[Said]:
    return [
        (time, "goal_hindrance", GoalHindrance(kind=kind, patience_used=used))
        for time, kind, used in said
    ]


def scans(*nearest: float, every: float = 0.5) -> list[Said]:
    return [
        (every * index, "scan", LaserScan(ranges=[3.0, value, float("inf")]))
        for index, value in enumerate(nearest)
    ]


def test_what_is_taken_from_a_message_fits_where_it_goes(rules: dict[str, Rule]) -> None:
    made: list[Any] = []
    for rule in rules.values():
        (_, leaf), *_ = leaves(rule.event.condition)
        trigger = ros_class(leaf.signal.type)() if hasattr(leaf, "signal") else None
        for action in rule.actions:
            kind = getattr(action, "type", "")
            given = expand(resolve(arguments_of(action), trigger))
            if "/msg/" in kind:
                made.append(fill(ros_class(kind)(), given))
            elif "/srv/" in kind:
                made.append(fill(ros_class(kind).Request(), given))
            elif "/action/" in kind:
                made.append(fill(ros_class(kind).Goal(), given))
    assert len(made) >= 4  # a goal, a map, a pose, a stop


def test_a_click_is_logged_each_time(rules: dict[str, Rule]) -> None:
    clicks: list[Said] = [(float(n), "clicked_point", PointStamped()) for n in range(3)]
    assert firings(rules["log-clicks"], clicks) == [0.0, 1.0, 2.0]


def test_an_edge_fires_at_the_second_and_the_fifth_scan(rules: dict[str, Rule]) -> None:
    said = scans(0.8, 0.4, 0.3, 0.7, 0.4)
    assert firings(rules["near"], said) == [0.5, 2.0]
    level = rules["near"].model_copy(
        update={"event": rules["near"].event.model_copy(update={"trigger": "level"})}
    )
    assert firings(level, said) == [0.5, 1.0, 2.0]


def test_hold_waits_and_begins_anew_after_one_scan_above(rules: dict[str, Rule]) -> None:
    near = rules["near-for-a-while"]
    assert firings(near, scans(*[0.4] * 6)) == [2.0]
    assert firings(near, scans(0.4, 0.4, 0.9, 0.4, 0.4, 0.4, 0.4, 0.4)) == [3.5]


def test_hold_begins_anew_after_a_silence(rules: dict[str, Rule]) -> None:
    silent: list[Said] = [(0.0, *scans(0.4)[0][1:]), (4.0, *scans(0.4)[0][1:])]
    assert firings(rules["near-for-a-while"], silent) == []


def test_a_stuck_controller_is_freed_twice_a_minute_at_most(rules: dict[str, Rule]) -> None:
    stuck = ComponentStatus(status=ComponentStatus.STATUS_FAILURE_ALGORITHM_LEVEL)
    said: list[Said] = [(0.5 * n, "controller/status", stuck) for n in range(130)]
    assert firings(rules["stuck-unblock"], said) == [0.0, 30.0, 60.0]


def test_a_hiccup_does_not_use_up_the_rule_of_the_mapper(rules: dict[str, Rule]) -> None:
    failed = ComponentStatus(status=ComponentStatus.STATUS_FAILURE_SYSTEM_LEVEL)
    well = ComponentStatus()
    said: list[Said] = [(0.0, "mapper/status", failed), (0.2, "mapper/status", well)]
    said += [(1.0 + 0.2 * n, "mapper/status", failed) for n in range(40)]
    assert firings(rules["mapper-lost"], said) == [1.5]


def test_somebody_who_walks_about_in_the_way_is_waited_for(rules: dict[str, Rule]) -> None:
    said = hindrances(
        (0.0, "moving", 0.05),
        (0.5, "seen", 0.2),
        (1.0, "moving", 0.2),
        (1.5, "moving", 0.25),
        (2.0, "", 0.0),
        (2.5, "moving", 0.15),
    )
    assert firings(rules["let-people-pass"], said) == [1.0, 2.5]


def test_silence_is_noticed_without_a_message(rules: dict[str, Rule]) -> None:
    said = [*scans(1.0, 1.0, 1.0), (6.0, "", None)]
    assert firings(rules["scan-silent"], said) == [3.0]
    assert firings(rules["scan-silent"], [(6.0, "", None)]) == [2.0]  # never spoke
    assert firings(rules["scan-back"], scans(*[1.0] * 5)) == [0.0, 1.0, 2.0]


def test_slow_odometry_is_noticed(rules: dict[str, Rule]) -> None:
    fast: list[Said] = [(0.05 * n, "odometry/filtered", Odometry()) for n in range(100)]
    slow: list[Said] = [(0.2 * n, "odometry/filtered", Odometry()) for n in range(25)]
    assert firings(rules["odometry-slow"], fast) == []
    assert firings(rules["odometry-slow"], slow) == [2.0]


def test_fast_and_near_needs_both_and_a_live_odometry(rules: dict[str, Rule]) -> None:
    moving, standing = Odometry(), Odometry()
    moving.twist.twist.linear.x = 0.2
    near = scans(0.2, 0.2, 0.2)
    fast: list[Said] = [(0.1, "odometry/filtered", moving)]
    slow: list[Said] = [(0.1, "odometry/filtered", standing)]
    assert firings(rules["fast-and-near"], near + fast) == [0.1]
    assert firings(rules["fast-and-near"], near + slow) == []
    assert firings(rules["fast-and-near"], near) == []


def test_two_thresholds_keep_a_battery_from_flickering(rules: dict[str, Rule]) -> None:
    charges = (0.25, 0.19, 0.21, 0.19, 0.35, 0.19)
    said: list[Said] = [
        (float(n), "battery_state", BatteryState(percentage=charge))
        for n, charge in enumerate(charges)
    ]
    assert firings(rules["battery-low"], said) == [1.0, 5.0]


def test_a_band_is_said_once_on_the_way_down(rules: dict[str, Rule]) -> None:
    said: list[Said] = [
        (float(n), "battery_state", BatteryState(percentage=charge))
        for n, charge in enumerate((0.5, 0.39, 0.3, 0.2, 0.1, 0.3))
    ]
    assert firings(rules["battery-medium"], said) == [1.0, 5.0]
    # A 32-bit number on its way over the wire: what was sent as 0.4 lies above it.
    sent = BatteryState(percentage=0.4)
    come = deserialize_message(serialize_message(sent), BatteryState)
    assert firings(rules["battery-medium"], [(0.0, "battery_state", come)]) == []


def test_the_third_restart_in_ten_minutes_latches(rules: dict[str, Rule]) -> None:
    defect = ComponentStatus(status=ComponentStatus.STATUS_FAILURE_COMPONENT_LEVEL)
    said: list[Said] = [(0.5 * n, "planner/status", defect) for n in range(120)]
    assert len(firings(rules["planner-restart"], said)) == 2


def test_a_change_is_told_and_noise_is_not(rules: dict[str, Rule]) -> None:
    modes: list[Said] = [
        (float(n), "robot_mode", String(data=mode)) for n, mode in enumerate("aabb")
    ]
    assert firings(rules["mode-changed"], modes) == [2.0]
    drift: list[Said] = [
        (float(n), "temperature", Temperature(temperature=20.0 + 0.5 * n)) for n in range(10)
    ]
    assert firings(rules["warmer-or-colder"], drift) == [5.0]


def test_an_edge_of_the_floor_fires_at_once(rules: dict[str, Rule]) -> None:
    said: list[Said] = [(0.0, "cliff", Bool(data=False)), (0.3, "cliff", Bool(data=True))]
    assert firings(rules["drop-edge"], said) == [0.3]
