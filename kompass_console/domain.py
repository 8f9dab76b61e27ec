"""Choose the ROS domain of a command, before ROS is loaded."""

from __future__ import annotations

import os

from kompass_console.cli_error import CliError


def choose_domain(domain_id: int | None, *, alone: bool) -> None:
    """Set what rclpy reads from the environment; a robot of our own stays on this machine.

    Comes before rclpy is imported: with a middleware it does not find it ends the process.

    Raises
    ------
    CliError
        When ROS could not start with what the environment says.
    """
    from kompass.launch.environment import EnvironmentProblem, check_environment
    from kompass.rclpy_ext.middleware import RANGE, prepare_middleware

    if domain_id is not None:
        os.environ["ROS_DOMAIN_ID"] = str(domain_id)
    if alone:
        os.environ.setdefault(RANGE, "LOCALHOST")
        prepare_middleware()
    try:
        check_environment()
    except EnvironmentProblem as error:
        raise CliError(1, str(error)) from None
