"""Faults of the machine, as the robot, the monitor and people meet them in a drill."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any, cast

import pytest

from kompass.drills.draw import expand_faults
from kompass.drills.drive import DriveMoment, DriveResult
from kompass.drills.report_json import Report
from kompass.drills.scenario import Goal, OperatorAct, Scenario, ScheduledFault
from kompass.drills.scenario_file import scenario_text
from kompass.launch.virtual_faults import VirtualFaults
from kompass.simulation.faults.fault_manager import FaultManager, FaultRefused
from kompass.simulation.faults.fault_names import MACHINE_FAULTS, UnknownFault, parse_fault
from tests.support.patience import patient

pytestmark = pytest.mark.ros

RECIPE = Path(__file__).parents[2] / "recipes" / "03_events_and_actions.py"
NODES = ("planner", "controller", "mapper", "drive_manager")
AT, BOXED_IN, KILLED = 6.0, 8.0, 11.0  # s
LATER = {"boxed_in": BOXED_IN, "kill:drive_manager": KILLED}
STOP = OperatorAct(at=9.0, does="stop", by="ava", reason="a child on the floor")


def scenario(name: str, *faults: str, lasts: float = 0.0, stop: bool = False) -> Scenario:
    """A short drive in which the first fault lasts so long, and the others for ever."""
    broken = [
        ScheduledFault(name=fault, at=LATER.get(fault, AT), duration=0.0 if index else lasts)
        for index, fault in enumerate(faults)
    ]
    return Scenario(
        name=name,
        world="hexagon",
        seed=5,
        goals=(Goal(x=0.0, y=-1.7, at=2.0),),
        faults=tuple(broken),
        operators=(STOP,) if stop else (),
        limit=35.0 if name.startswith("hang") else 16.0,
    )


DRIVES = [
    scenario("well", "boxed_in"),
    scenario("hang", "hang:controller"),
    scenario("hang and return", "hang:controller", lasts=5.0),
    scenario("flicker", "flicker:controller"),
    scenario("starve", "starve:monitor", "boxed_in"),
    scenario("late", "network_late:0.2", "boxed_in"),
    scenario("loss", "network_loss:0.95"),
    scenario("disk full", "disk_full", "kill:drive_manager", stop=True),
]


@pytest.fixture(scope="module")
def drives(tmp_path_factory: pytest.TempPathFactory) -> dict[str, DriveResult]:
    folder = tmp_path_factory.mktemp("scenarios")
    for number, drive in enumerate(DRIVES):
        (folder / f"{number}.yaml").write_text(scenario_text(drive))
    report = folder / "report.json"
    console = Path(sys.executable).with_name("kompass-console")
    drill = (console, "drill", RECIPE, "--scenarios", folder, "--json", report, "--jobs", "1")
    subprocess.run(list(map(str, drill)), check=True, timeout=patient(200))
    results = Report.model_validate_json(report.read_text()).drives
    return {result.scenario.name: result for result in results}


def told(drive: DriveResult, kind: str) -> list[DriveMoment]:
    """What happened of a kind."""
    return [moment for moment in drive.moments if moment.kind == kind]


def until_fired(drive: DriveResult) -> float:
    """From the beginning of the walls around the robot to the rule that answers it [s]."""
    (began,) = (fault.began for fault in drive.faults if fault.name == "boxed_in")
    return drive.firings[0].at - began


def test_what_does_not_return_is_killed_and_started_again(drives: dict[str, DriveResult]) -> None:
    drive = drives["hang"]

    (spoken_for,) = [each for each in told(drive, "status") if "not come round" in each.text][:1]
    assert 2.5 <= spoken_for.at - AT < 3.0
    assert [round(hang.at - AT) for hang in told(drive, "hang")] == [3]
    (death,) = told(drive, "death")
    assert round(death.at - AT) == 13
    assert "it was stuck for 11 s" in death.text
    assert drive.outcome == "recovered"
    assert not drive.broken


def test_what_hangs_for_a_while_stands_and_goes_on(drives: dict[str, DriveResult]) -> None:
    drive = drives["hang and return"]

    assert drive.disturbed
    assert not told(drive, "death")
    assert drive.outcome == "recovered"


def test_what_flickers_is_told_to_be_stuck_again_and_again(drives: dict[str, DriveResult]) -> None:
    deaths = told(drives["flicker"], "hang")

    assert len(deaths) >= 4
    assert {death.text.partition(": ")[2] for death in deaths} == {
        "the process was stopped by a signal"
    }
    assert len(told(drives["flicker"], "restart")) >= len(deaths) - 1


def test_a_starved_monitor_answers_later(drives: dict[str, DriveResult]) -> None:
    later = until_fired(drives["starve"]) - until_fired(drives["well"])

    assert 0.003 < later < 0.2


def test_on_a_late_network_all_that_takes_a_message_is_later(
    drives: dict[str, DriveResult],
) -> None:
    # The scan, and what the controller says of it.
    later = until_fired(drives["late"]) - until_fired(drives["well"])
    assert later == pytest.approx(0.4, abs=0.06)


def test_where_most_is_lost_the_robot_says_that_it_sees_nothing(
    drives: dict[str, DriveResult],
) -> None:
    assert any("nothing on /scan" in each.text for each in told(drives["loss"], "status"))
    # What people see of the robot is not what the machine loses.
    assert not told(drives["loss"], "blind")


def test_stop_holds_though_nothing_can_be_written_and_the_gate_dies(
    drives: dict[str, DriveResult],
) -> None:
    drive = drives["disk full"]

    assert told(drive, "death")
    assert told(drive, "restart")
    assert drive.outcome == "stopped"
    assert not drive.broken


def test_a_full_disk_takes_nothing_and_has_room_again_when_the_fault_ends(tmp_path: Path) -> None:
    file = tmp_path / "kept"
    faults = VirtualFaults(cast(Any, None))  # the disk is no part of the virtual world

    faults.begin("disk_full")
    try:
        with pytest.raises(OSError, match="File too large"):
            file.write_text("more")
    finally:
        faults.close()
    file.write_text("more")


def test_all_faults_of_a_drill_are_those_of_the_robot_and_of_the_machine() -> None:
    kinds = {name.partition(":")[0] for name in expand_faults(["all"], NODES)}

    assert {name.partition(":")[0] for name in MACHINE_FAULTS} <= kinds
    assert {"hang:planner", "starve:drive_manager", "network_late:0.1"} <= set(
        expand_faults(["all"], NODES)
    )


def test_the_robot_in_real_time_refuses_them_and_says_who_has_them() -> None:
    with pytest.raises(UnknownFault, match=r"'hang:mapper' is one of the machine.*stop:mapper"):
        parse_fault("hang:mapper:20")
    manager = FaultManager((), (), 0.0, lambda _: None)
    with pytest.raises(FaultRefused, match="kompass-console drill RECIPE --faults disk_full"):
        manager.switch("disk_full", True, 0.0, 1.0)


def test_an_amount_that_makes_no_sense_is_refused() -> None:
    with pytest.raises(UnknownFault, match=r"network_loss:1.5.*up to 1"):
        expand_faults(["network_loss:1.5"], NODES)
    with pytest.raises(UnknownFault, match="needs DELAY"):
        expand_faults(["network_late:"], NODES)
