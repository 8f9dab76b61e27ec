"""The environment variables; their names come from the modules that read them."""

from __future__ import annotations

from docs.hooks.markup import code, table
from kompass.access.ros_control import DEFAULT, ROS_CONTROL
from kompass.launch.environment import MIDDLEWARE
from kompass.monitor.settings import DEFAULT_PROBATION, PROBATION, SAFE_MODE
from kompass.rclpy_ext.middleware import PEERS, RANGE
from kompass.recorder.clip_policy import SETTING as KEEP_FIRINGS
from kompass.recorder.process import SETTING as RECORD
from kompass.store.paths import DATA_DIR, ROBOT_NAME, STATE_HOME
from kompass.store.robot_key import GIVEN

INTRODUCTION = """# Environment variables

An option of the command line comes before its variable. `kompass-console rules` reads those of ROS
alone. A recipe that is run with Python alone, without `kompass-console`, has ROS's own defaults.
"""
# name, option, default, meaning
VARIABLES: tuple[tuple[str, str, str, str], ...] = (
    (DATA_DIR, "--data-dir", "see below", "Folder of all robots' rules, journals and recordings."),
    (ROBOT_NAME, "--name", "this machine's name", "The robot: its folder, and what the page says."),
    (
        "KOMPASS_CONSOLE_TOKEN",
        "--token",
        "a new one at each start",
        "The operator's token, at least 16 characters.",
    ),
    (
        ROS_CONTROL,
        "--ros-control",
        f"`{DEFAULT}`",
        "What may be done over ROS without the robot's key: `off`, `read` or `full`.",
    ),
    ("KOMPASS_WEBHOOKS", "--webhooks", "nobody is told", "File of addresses that are told."),
    (GIVEN, "--robot-key", "the one in the data folder", "File of the robot's key."),
    (SAFE_MODE, "--safe-mode", "off", "`1`: begin with the recipe's rules; edits are kept."),
    (RECORD, "--no-record", "on", "`0`: no flight recorder."),
    (
        KEEP_FIRINGS,
        "",
        "error",
        "From which severity on what surrounds a firing is kept: `info`, `warning`, `error`, "
        "`critical`, or `never`.",
    ),
    (
        PROBATION,
        "",
        f"{DEFAULT_PROBATION:g}",
        "Seconds after which an applied table is taken back unless confirmed; `0` for never.",
    ),
    (
        "KOMPASS_MULTI_PROCESSING",
        "--single-process",
        "as the recipe says",
        "`0`: all components in one process; `1`: a process each.",
    ),
    ("ROS_DOMAIN_ID", "--domain-id", "0", "ROS domain."),
    (
        RANGE,
        "--network",
        "LOCALHOST; ROS's own is SUBNET",
        "Who is met over ROS: `LOCALHOST`, `SUBNET`, `OFF`.",
    ),
    (PEERS, "--network", "none", "Machines that are met besides, with `;` between."),
    (MIDDLEWARE, "", "rmw_fastrtps_cpp", "ROS middleware; must be installed in this environment."),
    (
        "ROS_DISTRO",
        "",
        "jazzy with the wheels",
        "Recipes read it to choose between `Twist` and `TwistStamped` for `/cmd_vel`.",
    ),
    (
        STATE_HOME,
        "",
        "~/.local/state",
        f"Where `{DATA_DIR}` is not set, data are in its subfolder `kompass`.",
    ),
)
FOR_TESTS: tuple[tuple[str, str], ...] = (
    ("KOMPASS_BROWSER", "The Chromium of the browser tests."),
    ("KOMPASS_TEST_PATIENCE", "How many times longer than on a quiet machine tests wait."),
    ("KOMPASS_TEST_WORKERS", "How many files of tests run at a time."),
    ("KOMPASS_EXAMPLES", "Examples for each long property."),
    ("KOMPASS_RULES_SWAPS", "Examples for the properties of changing tables."),
)


def environment_page() -> str:
    """What a running stack reads, then what its tests read."""
    rows = [
        (code(name), code(option) if option else "", default, text)
        for name, option, default, text in VARIABLES
    ]
    tests = [(code(name), text) for name, text in FOR_TESTS]
    return "\n".join(
        [
            INTRODUCTION,
            table(("variable", "option", "default", "what it says"), rows),
            "## For the tests\n",
            table(("variable", "what it says"), tests),
        ]
    )
