"""For the benchmarks: four components that do nothing, ten times a second."""

from kompass.components.base.component import Component
from kompass.ros import Launcher


class Idler(Component):
    """Alive, and no more."""


launcher = Launcher()
launcher.kompass(components=[Idler(f"idler_{number}") for number in range(4)])
launcher.bringup()
