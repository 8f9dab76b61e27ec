"""What fragments of Python in the documentation take for granted."""

from tests.docs.blocks import ROOT


class Bringup(Exception):
    """The recipe is read; its stack is not started."""


_RECIPE = (ROOT / "recipes" / "01_point_navigation.py").read_text(encoding="utf-8")

PRELUDES = {
    # The names that recipe 01 and its imports define, up to its bring-up.
    "recipe": _RECIPE.replace("launcher.bringup()\n", "")
    + """
from automatika_ros_sugar.msg import ComponentStatus

from kompass.actions import Action, ComponentActions, LogInfo, update_parameter
from kompass.ros import Event
""",
    # The components of recipe 01, and a launcher that has none yet.
    "components": _RECIPE.partition("launcher = Launcher()")[0]
    + """
from automatika_ros_sugar.msg import ComponentStatus

from kompass.actions import Action, LogInfo, update_parameter
from kompass.ros import Event

launcher = Launcher()
""",
}
