"""Which files of tests come first when they are given to several workers, and which go together.

A worker takes a file as soon as it is free. With the longest at the beginning all of them end
together; with the longest at the end, one works on while the others stand idle.
"""

from pathlib import Path

TESTS = Path(__file__).parents[1]

# Files whose pages draw their scene. One worker has all of them, for without a GPU two scenes at
# once leave each other, and the robots beside them, too little of the processor.
DRAWN = (
    "browser/test_driving.py",
    "browser/test_watching.py",
    "browser/test_camera.py",
    "browser/test_drills.py",
    "browser/test_zones.py",
    "browser/test_places.py",
    "browser/test_locate.py",
    "browser/test_measuring.py",
)
# By their seconds, about the longest first; what takes less than about 10 s need not be here.
LONGEST = (
    *DRAWN,
    "browser/test_rules.py",
    "stack/test_missions.py",
    "stack/test_recovery.py",
    "ros/test_supervisor_killed.py",
    "ros/test_processes.py",
    "ros/test_seeds.py",
    "drills/test_runner.py",
    "stack/test_several_sensors.py",
    "stack/test_navigation.py",
    "stack/test_seen_obstacles.py",
    "ros/test_recipes.py",
    "drills/test_recorded.py",
    "security/test_ros_control.py",
    "security/test_neighbour.py",
    "ros/test_rules_live.py",
    "browser/test_own_drills.py",
    "browser/test_drilled_cooldown.py",
    "bench/test_command.py",
    "ros/test_recorder.py",
    "browser/test_control.py",
    "browser/test_missions.py",
    "browser/test_timeline.py",
    "simulation/test_node.py",
    "console/test_link.py",
    "console/test_drills_stack.py",
    "drills/test_machine_faults.py",
    "ros/test_supervision.py",
    "rclpy_ext/test_messages.py",
    "ros/test_rules_in_need.py",
    "ros/test_recorded_drives.py",
    "ros/test_patrol.py",
    "ros/test_own_components.py",
    "ros/test_standstill.py",
    "ros/test_refused_commands.py",
    "console/test_rules_cli.py",
    "ros/test_navigation.py",
    "browser/test_accessibility.py",
    "browser/test_by_hand.py",
    "browser/test_flat_map.py",
    "supervisor/test_supervisor.py",
    "virtual/test_bus_contract.py",
    "drills/test_draw.py",
    "console/test_drills.py",
    "console/test_rules_api.py",
    "console/test_audit.py",
    "ros/test_channels.py",
    "ros/test_as_said.py",
    "security/test_outsider.py",
    "docs/test_first_hour.py",
    "stack/test_interrupted.py",
    "algorithms/test_mppi.py",
    "stack/test_control_path.py",
    "stack/test_motion_server.py",
    "stack/test_tracking.py",
    "stack/test_zones.py",
    "stack/test_stale_sensors.py",
    "stack/test_components.py",
    "recipe/test_random_recipes.py",
)
# Drives have the lowest priority: they are quick when nobody else is left, and use both processors.
LAST = ("drills/test_command.py", "drills/test_random_drives.py")

_RANKS = {TESTS / name: rank for rank, name in enumerate(LONGEST)}
_RANKS |= {TESTS / name: len(LONGEST) + 1 + rank for rank, name in enumerate(LAST)}


def rank(path: Path) -> int:
    """Where a file comes; those that are not named keep the order that they have."""
    return _RANKS.get(path, len(LONGEST))


def scope(node_id: str) -> str:
    """What is given to one worker as a whole: the file of a test, or all files that draw."""
    file = node_id.split("::", 1)[0]
    return "drawn" if file.removeprefix("tests/") in DRAWN else file
