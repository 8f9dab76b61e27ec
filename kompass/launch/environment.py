"""What the environment says, and what must be right in it before ROS is touched."""

import importlib.util
import os
from pathlib import Path

from kompass.access.ros_control import ros_control
from kompass.store.robot_key import UnusableKey, robot_key

MIDDLEWARE = "RMW_IMPLEMENTATION"
MULTI_PROCESSING = "KOMPASS_MULTI_PROCESSING"


class EnvironmentProblem(RuntimeError):
    """The environment cannot run ROS; the message says what to change."""


def check_environment() -> None:
    """Check the middleware and the domain, and what may be done over ROS.

    Raises
    ------
    EnvironmentProblem
        When rcl would end the process with a message of its own, or another domain be used.
    """
    try:
        ros_control()
    except ValueError as error:
        raise EnvironmentProblem(str(error)) from None
    name = os.environ.get(MIDDLEWARE, "")
    if name and not _has_library(name):
        raise EnvironmentProblem(
            f"{MIDDLEWARE}={name}, but that middleware is not installed in this environment; "
            f"unset {MIDDLEWARE}, or set it to rmw_fastrtps_cpp"
        )
    domain = os.environ.get("ROS_DOMAIN_ID", "")
    if domain and not (domain.isdigit() and int(domain) <= 232):
        raise EnvironmentProblem(
            f"ROS_DOMAIN_ID={domain!r} is not a number from 0 to 232; choose one, or unset it"
        )
    if importlib.util.find_spec("rclpy") is None:
        raise EnvironmentProblem(
            "rclpy is not installed; on x86_64 Linux 'pip install kompass-console' brings it, "
            "elsewhere source a ROS 2 installation first"
        )


def prepare_key() -> None:
    """Have the robot's key made or read before processes are forked, so that all have the same.

    Raises
    ------
    EnvironmentProblem
        When its file cannot be used.
    """
    try:
        robot_key()
    except UnusableKey as error:
        raise EnvironmentProblem(str(error)) from None


def processes_wanted(stated: bool | None) -> bool:
    """Whether components get a process each: as stated, unless the environment says otherwise.

    ``KOMPASS_MULTI_PROCESSING=0`` puts all into one process, ``1`` each into its own, whatever a
    recipe says: to debug a stack, or to save memory.

    Parameters
    ----------
    stated
        By the recipe; None where it says nothing, which is a process each.

    Raises
    ------
    ValueError
        When the variable holds something else.
    """
    override = os.environ.get(MULTI_PROCESSING, "")
    if override not in ("", "0", "1"):
        raise ValueError(f"{MULTI_PROCESSING}={override!r} is neither 0 nor 1")
    return override == "1" if override else stated is not False


def _has_library(middleware: str) -> bool:
    folders = os.environ.get("LD_LIBRARY_PATH", "").split(os.pathsep)
    spec = importlib.util.find_spec("rclpy")
    if spec is not None and spec.origin is not None:
        # The wheels put their libraries into <prefix>/lib.
        folders += [str(parent / "lib") for parent in Path(spec.origin).parents[:6]]
    return any((Path(folder) / f"lib{middleware}.so").is_file() for folder in folders if folder)
