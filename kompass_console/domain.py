"""Choose the ROS domain of a command and who can be met on it, before ROS is loaded."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

import typer

from kompass_console.cli_error import CliError

LOCAL, SUBNET = "local", "subnet"
LOCALHOST_ONLY = "ROS_LOCALHOST_ONLY"  # what older releases of ROS had instead of the range

Network = Annotated[
    str | None,
    typer.Option(
        metavar="local|subnet|PEER,…",
        help="Who is met over ROS: this machine alone, everybody on the subnet, or the machines "
        "named. Else what the ROS variables say, else local.",
        show_default=False,
    ),
]


RobotKey = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE",
        help="The robot's key; else KOMPASS_ROBOT_KEY, else the one in its data folder.",
        show_default=False,
    ),
]
RosControl = Annotated[
    str | None,
    typer.Option(
        metavar="off|read|full",
        help="What may be done over ROS without the robot's key: nothing, look, or everything. "
        "Else KOMPASS_ROS_CONTROL, else read. STOP may be pressed by anybody.",
        show_default=False,
    ),
]


def choose_key(file: Path | None) -> None:
    """Take the robot's key from a file, in this process and its children.

    Raises
    ------
    CliError
        When the file, or the one that the environment names, cannot be used.
    """
    from kompass.store.robot_key import GIVEN, UnusableKey, read_key

    if file is not None:
        os.environ[GIVEN] = str(file.absolute())
    if given := os.environ.get(GIVEN):
        try:
            read_key(Path(given), given=True)
        except UnusableKey as error:
            said = "--robot-key" if file is not None else GIVEN
            raise CliError(2, f"{said}: {error}") from None


def choose_ros_control(mode: str | None) -> str:
    """Say what may be done over ROS without the robot's key, in this process and its children.

    Returns
    -------
    str
        The same in words, to go on from those of `choose_domain`; empty for what is usual.

    Raises
    ------
    CliError
        When there is no such mode.
    """
    from kompass.access.ros_control import MODES, ROS_CONTROL, ros_control

    if mode is not None:
        if mode not in MODES:
            raise CliError(2, f"--ros-control {mode}: give one of {', '.join(MODES)}")
        os.environ[ROS_CONTROL] = mode
    words = {
        "off": "; whoever has not its key is not even answered (--ros-control off)",
        "full": "; whoever is met there may change everything (--ros-control full)",
    }
    return words.get(ros_control(), "")


def choose_domain(domain_id: int | None, network: str | None) -> str:
    """Set what rclpy reads from the environment, for this process and its children.

    Comes before rclpy is imported: with a middleware it does not find it ends the process.

    Parameters
    ----------
    network
        ``local``, ``subnet`` or peers with commas between; None to respect what the environment
        says, and keep to this machine where it says nothing.

    Returns
    -------
    str
        Domain and network in words, and who says so.

    Raises
    ------
    CliError
        When ROS could not start with what the environment says, or not as asked for.
    """
    from kompass.launch.environment import EnvironmentProblem, check_environment
    from kompass.rclpy_ext.middleware import PEERS, PROFILES, RANGE, is_ours, prepare_middleware

    if domain_id is not None:
        os.environ["ROS_DOMAIN_ID"] = str(domain_id)
    says = [name for name in (PROFILES, RANGE, PEERS, LOCALHOST_ONLY) if os.environ.get(name)]
    if PROFILES in says and is_ours(os.environ[PROFILES]):
        says.remove(PROFILES)  # it stands for the range, which was there
    if PROFILES in os.environ and not is_ours(os.environ[PROFILES]):
        if network is not None:
            raise CliError(
                2,
                f"--network {network} cannot be carried out while {PROFILES}="
                f"{os.environ[PROFILES]} says how DDS finds others; unset one of them",
            )
    elif network is not None:
        named = [] if network in (LOCAL, SUBNET) else _peers(network)
        for name in (RANGE, PEERS, PROFILES, LOCALHOST_ONLY):
            os.environ.pop(name, None)
        os.environ[RANGE] = "SUBNET" if network == SUBNET else "LOCALHOST"
        if named:
            os.environ[PEERS] = ";".join(named)
    elif os.environ.get(LOCALHOST_ONLY) == "1":
        del os.environ[LOCALHOST_ONLY]
        os.environ[RANGE] = "LOCALHOST"
    elif not os.environ.get(RANGE):
        os.environ[RANGE] = "LOCALHOST"
    try:
        prepare_middleware()
        check_environment()
    except (EnvironmentProblem, PermissionError) as error:
        raise CliError(1, str(error)) from None
    if network is None and says:
        return f"{where()}, as {' and '.join(says)} in the environment says"
    return f"{where()} (--network {network or LOCAL})"


def where() -> str:
    """Domain and network of this process, in words."""
    from kompass.rclpy_ext.middleware import PEERS, PROFILES, RANGE, SUBNET_PROFILE, is_ours, peers

    domain = f"ROS domain {os.environ.get('ROS_DOMAIN_ID') or '0'}"
    if on_this_machine_only():
        return f"{domain}, on this machine only"
    profiles = os.environ.get(PROFILES, "")
    reach = os.environ.get(RANGE, "").upper()
    if profiles and not is_ours(profiles):
        return f"{domain}, on the network that {PROFILES}={profiles} says"
    if profiles in {"", str(SUBNET_PROFILE)} and reach != "LOCALHOST":
        if reach == "OFF":
            return f"{domain}, on no network ({RANGE}=OFF)"
        more = f" and {PEERS}={os.environ[PEERS]}" if peers() else ""
        return f"{domain}, on the whole subnet{more}"
    return f"{domain}, on this machine and {', '.join(peers())}"


def on_this_machine_only() -> bool:
    """Whether this process meets nobody of another machine over ROS."""
    from kompass.rclpy_ext.middleware import PROFILES, RANGE, SUBNET_PROFILE, is_ours, peers

    profiles = os.environ.get(PROFILES, "")
    if (profiles and not is_ours(profiles)) or peers():
        return False
    reach = os.environ.get(RANGE, "").upper()
    return reach == "LOCALHOST" or profiles not in {"", str(SUBNET_PROFILE)}


def look_elsewhere() -> str:
    """What to try when nothing was found where this process looks."""
    return (
        "if it is on another machine give --network subnet, or its address (--network ADDRESS), "
        "to both; if it is on another domain its --domain-id"
    )


def _peers(network: str) -> list[str]:
    """The machines that ``--network`` names.

    Raises
    ------
    CliError
        When one of them is not known.
    """
    from kompass.rclpy_ext.middleware import addresses_of

    named = [name.strip() for name in network.split(",")]
    for name in named:
        if name in (LOCAL, SUBNET):
            raise CliError(2, f"--network {network}: '{name}' stands alone, without other names")
        if not name or ";" in name or not addresses_of(name):
            raise CliError(
                2,
                f"--network {network}: '{name}' is neither 'local' nor 'subnet' nor a machine with "
                "an IPv4 address; give addresses or names that this machine knows, with commas",
            )
    return named
