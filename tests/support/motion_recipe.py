"""Recipe 01 with a motion server, as a user would add one."""

from pathlib import Path

from tests.support.stack import RECIPE

LAUNCHER = "launcher = Launcher()\n"
COMPONENTS = "mapper, driver]"


def motion_recipe(folder: Path, period: float, settings: str = "", run_type: str = "Event") -> Path:
    """The recipe, written into a folder.

    Parameters
    ----------
    period
        Of each leg [s].
    settings
        More of the motion server's, as its keywords.
    """
    text = RECIPE.read_text(encoding="utf-8")
    assert text.count(LAUNCHER) == text.count(COMPONENTS) == 1
    server = f"""from kompass.components import MotionServer, MotionServerConfig

motion = MotionServer(config=MotionServerConfig(test_period={period}, {settings}))
motion.run_type = {run_type!r}
motion.inputs(command=driver.get_out_topic("robot_command"))

{LAUNCHER}"""
    text = text.replace(LAUNCHER, server).replace(COMPONENTS, "mapper, driver, motion]")
    made = folder / "tested_base.py"
    made.write_text(text, encoding="utf-8")
    return made
