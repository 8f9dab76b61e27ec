"""Faults in any number and order: no exception, the same for the same seed, and nothing left."""

from contextlib import suppress
from hashlib import sha256

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from kompass.simulation.faults.fault_manager import FaultManager, NotYet
from kompass.simulation.faults.fault_names import FAULTS, UnknownFault
from kompass.simulation.faults.fault_parameters import PARAMETERS
from kompass.simulation.faults.robot_faults import RobotFaults
from kompass.simulation.physics.parts import NoReading
from kompass.simulation.robot import SimulatedRobot
from kompass.simulation.worlds.registry import world

PERIOD = 0.1
WORLD = world("apartment")
KINDS = [
    f"{kind}:{PARAMETERS[kind].example}" if kind in PARAMETERS else kind
    for kind in (shown.partition(":")[0] for shown in FAULTS)
    if RobotFaults(SimulatedRobot(WORLD)).knows(kind)
]
NAMES = [
    *KINDS,
    "scan_noise:0.2",
    "scan_late:0.1",
    "wheel_slip:right",
    "glass:1",
    "door_closed:study",
]

Switching = tuple[str, bool, float]
switchings = st.lists(
    st.tuples(st.sampled_from(NAMES), st.booleans(), st.sampled_from([0.0, 0.35])),
    min_size=1,
    max_size=25,
)


def readings(robot: SimulatedRobot) -> bytes:
    """All that the robot says of itself at one instant, byte for byte."""
    digest = sha256(np.array([robot.contacts, robot.person_contacts]).tobytes())
    for read in (robot.truth, robot.filtered, robot.wheel_odometry):
        with suppress(NoReading):
            motion = read()
            digest.update(np.array([*motion.pose, *motion.twist, motion.age]).tobytes())
            digest.update(motion.pose_covariance.tobytes())
    with suppress(NoReading):
        digest.update(robot.scan().tobytes())
        digest.update(np.array(robot.scan_age).tobytes())
    return digest.digest()


def run(seed: int, sequence: list[Switching]) -> tuple[SimulatedRobot, FaultManager, list[bytes]]:
    robot = SimulatedRobot(WORLD, seed)
    manager = FaultManager([RobotFaults(robot)], [], 0.0, lambda _: None)
    said = []
    for tick, (name, on, duration) in enumerate(sequence):
        now = tick * PERIOD
        with suppress(NotYet, UnknownFault):  # a robot without a camera
            manager.switch(name, on, duration, now)
        manager.advance(now)
        robot.command(0.25, 0.3)
        robot.step(PERIOD)
        said.append(readings(robot))
    return robot, manager, said


def make(robot: SimulatedRobot) -> tuple[object, ...]:
    """What the robot and its surroundings are made of, apart from where it is."""
    return (
        *(
            type(part)
            for part in (robot.battery, robot.drive, robot.lidar, robot.localizer, robot.wheels)
        ),
        robot.slip,
        robot._lidar.mirrors,
        robot._model.geom_group.tobytes(),
        robot._data.mocap_pos.tobytes(),
        robot._people,
    )


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**16), switchings)
def test_any_sequence_repeats_byte_for_byte_and_leaves_nothing_behind(
    seed: int, sequence: list[Switching]
) -> None:
    robot, manager, said = run(seed, sequence)
    _, _, again = run(seed, sequence)
    assert said == again
    sound = SimulatedRobot(WORLD, seed)
    manager.close()
    assert make(robot) == make(sound)
    robot.place(WORLD.start)
    sound.place(WORLD.start)
    before, after = sound.scan(), robot.scan()
    # The robot has come to rest a few micrometres off, where a ray may pass an edge or not.
    assert (np.isinf(before) == np.isinf(after)).mean() > 0.97
    seen = np.isfinite(before) & np.isfinite(after)
    assert np.median(np.abs(before[seen] - after[seen])) < 0.02
    robot.step(1.0)
    assert np.abs(np.array(robot.filtered().pose) - robot.truth().pose).max() < 0.03


def test_another_seed_has_other_chances() -> None:
    for name in ("scan_noise:0.05", "glass:0.3", "mirrors:0.3", "localizer_jump:0.5"):
        made = []
        for seed in (1, 2):
            robot = SimulatedRobot(WORLD, seed)
            faults = RobotFaults(robot)
            quiet = np.array([*robot.filtered().pose, *np.nan_to_num(robot.scan(), posinf=9.0)])
            faults.begin(name)
            broken = np.array([*robot.filtered().pose, *np.nan_to_num(robot.scan(), posinf=9.0)])
            made.append(broken - quiet)
        assert np.abs(made[0] - made[1]).max() > 0.05, name


def test_what_one_fault_does_by_chance_is_not_changed_by_another() -> None:
    alone, accompanied = (SimulatedRobot(WORLD, 4) for _ in range(2))
    second = RobotFaults(accompanied)
    second.begin("glass:0.3")
    second.begin("localizer_drift:0.1")
    RobotFaults(alone).begin("localizer_jump:0.5")
    second.begin("localizer_jump:0.5")
    assert alone.filtered().pose == accompanied.filtered().pose
