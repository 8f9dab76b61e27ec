"""For tests: two components of one's own, of which one can be broken, and mends itself."""

from typing import Any

from std_srvs.srv import SetBool

from kompass.actions import Action
from kompass.components import Component
from kompass.ros import Launcher, Topic


class Flaky(Component):
    """Raises in each step while it is broken; its service breaks it."""

    broken = False

    def main_service_callback(self, request: Any, response: Any) -> Any:
        self.broken = request.data
        response.success = True
        return response

    def _execution_step(self) -> None:
        if self.broken:
            raise OSError("the device is gone")

    def mend(self) -> bool:
        """Not marked as an action: for the recipe."""
        self.broken = False
        return True


class Steady(Component):
    """Counts."""

    count = 0

    def _execution_step(self) -> None:
        self.count += 1
        self.publishers_dict["count"].publish(self.count)


flaky = Flaky("flaky", main_srv_type=SetBool)
flaky.on_component_fail(Action(flaky.mend))
steady = Steady("steady", outputs={"count": Topic(name="/count", msg_type="Int32")})
launcher = Launcher()
launcher.kompass(components=[flaky, steady], multi_processing=True)
launcher.bringup()
