"""``kompass-console rules``: its commands and its help."""

import typer

from kompass_console.rules_cli import backtest, change, edit, look

EXIT_CODES = """
Exit codes: 0 done, 1 there is no stack or the robot refused, 2 something in the command or the file
is wrong, 4 somebody else was faster (both changes are shown).

Whoever has the robot's key acts with the role of an engineer: the user who runs the robot, on its
machine, and others with --robot-key. What the recipe protects stays protected.
"""

app = typer.Typer(
    name="rules",
    help="Show, check, try, apply and take back the rules of a running robot.",
    epilog=EXIT_CODES,
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
)
look.add_to(app)
change.add_to(app)
edit.add_to(app)
backtest.add_to(app)
