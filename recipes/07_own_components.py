"""Components of your own: one on a clock, and one that answers requests.

Each is a class of a few lines, started, watched and restarted like ours. The battery's works on a
*clock*: this robot has no gauge, so what is left is reckoned from time and way. The notebook's
*answers requests*: asked through a service, it marks where the robot is. Rules connect them.

    kompass-console run recipes/07_own_components.py --sim

Try it: drive about until the battery is low, or have it drain faster: with a rule on the page whose
action sets the parameter lasts_metres of battery to 5 (Rules, New rule; it is checked there as ours
are). Another rule can call /mark_place, and the battery's action changed. From another terminal the
command ros2, if a ROS installation has brought it, asks for both:

    ros2 service call /mark_place std_srvs/srv/Trigger
    ros2 topic pub --times 3 /battery/changed std_msgs/msg/Empty

Its request for a parameter is refused, for it is not signed, unless the recipe is run with
--ros-control full:

    ros2 service call /battery/update_config_parameter automatika_ros_sugar/srv/ChangeParameter \\
        "{name: lasts_metres, value: '5.0', keep_alive: true}"

docs/components.md says what a component may override, and what it has at hand.
"""

import numpy as np
from geometry_msgs.msg import Pose, PoseArray
from pydantic import Field
from std_srvs.srv import Trigger

from kompass.actions import Action, LogInfo, send_srv_request
from kompass.components import (
    Component,
    Controller,
    DriveManager,
    LocalMapper,
    Planner,
    PlannerConfig,
    component_action,
)
from kompass.config import BaseComponentConfig
from kompass.robot import (
    AngularCtrlLimits,
    LinearCtrlLimits,
    RobotConfig,
    RobotGeometry,
    RobotType,
)
from kompass.ros import Event, Launcher, Topic

my_robot = RobotConfig(
    model_type=RobotType.DIFFERENTIAL_DRIVE,
    geometry_type=RobotGeometry.Type.CYLINDER,
    geometry_params=np.array([0.1, 0.3]),
    ctrl_vx_limits=LinearCtrlLimits(max_vel=0.22, max_acc=1.5, max_decel=2.5),
    ctrl_omega_limits=AngularCtrlLimits(max_vel=1.5, max_acc=3.0, max_decel=3.0),
)


class BatteryConfig(BaseComponentConfig):
    """What the battery is good for. A value out of bounds is refused, now and while it runs."""

    loop_rate: float = Field(default=2.0, ge=0.1, le=50.0, description="Hz")
    lasts_hours: float = Field(default=8.0, gt=0.0, description="standing")
    lasts_metres: float = Field(default=2000.0, gt=0.0, description="m driving")


class Battery(Component):
    """Reckons what is left in the battery [%], for a robot that cannot measure it."""

    config: BatteryConfig
    config_class = BatteryConfig

    def __init__(self, component_name: str, **kwargs) -> None:
        super().__init__(component_name, **kwargs)
        # Here and not in init_variables, so that a restart of the component keeps it.
        self.left = 100.0

    def init_variables(self) -> None:
        self.last: np.ndarray | None = None

    def _execute_once(self) -> None:
        self.get_logger().info(f"reckoning from {self.left:.0f} %")

    def _execution_step(self) -> None:
        if not self.got_all_inputs():
            return  # its status says what it waits for
        here = self.callbacks["location"].get_output()[:2]
        way = 0.0 if self.last is None else float(np.hypot(*(here - self.last)))
        self.last = here
        hours = 1.0 / self.config.loop_rate / 3600.0
        used = hours / self.config.lasts_hours + way / self.config.lasts_metres
        self.left = max(0.0, self.left - 100.0 * used)
        self.publishers_dict["level"].publish(self.left)  # a number becomes a message

    @component_action
    def changed(self) -> bool:
        """A full battery is in. Marked, so that rules made on the page may call it, too."""
        self.left = 100.0
        return True


class Notebook(Component):
    """Marks places on request, and publishes them all."""

    def __init__(self, component_name: str, **kwargs) -> None:
        super().__init__(component_name, **kwargs)
        self.places: list[Pose] = []

    def main_service_callback(
        self, request: Trigger.Request, response: Trigger.Response
    ) -> Trigger.Response:
        if not self.got_all_inputs():
            response.success, response.message = False, "nobody says where the robot is"
            return response
        odometry = self.input("location").message
        pose = odometry.pose.pose
        self.places.append(pose)
        places = PoseArray(header=odometry.header, poses=self.places)
        self.publishers_dict["places"].publish(places)
        where = f"({pose.position.x:.1f}, {pose.position.y:.1f})"
        response.success, response.message = True, f"place {len(self.places)} is at {where}"
        self.get_logger().info(response.message)
        return response

    def forget(self) -> bool:
        """Forget all. Not marked: this recipe's rules may call it, rules of people may not."""
        self.places.clear()
        return True


location = Topic(name="/odometry/filtered", msg_type="Odometry")
level = Topic(name="/battery/level", msg_type="Float32", data_timeout=5.0)
battery = Battery("battery", inputs={"location": location}, outputs={"level": level})
# What it does about a failure of its own, as an exception in one of its methods is.
battery.on_fail(action=Action(battery.restart), max_retries=3)

places = Topic(name="/places", msg_type="PoseArray")
notebook = Notebook(
    "notebook",
    main_srv_type=Trigger,
    inputs={"location": location},
    outputs={"places": places},
)
notebook.run_type = "Server"
notebook.main_srv_name = "mark_place"

planner = Planner(component_name="planner", config=PlannerConfig(goals_from_topics=True))
planner.run_type = "ActionServer"
planner.inputs(goal_point=Topic(name="/clicked_point", msg_type="PointStamped"))
controller = Controller(component_name="controller")
mapper = LocalMapper(component_name="mapper")
driver = DriveManager(component_name="drive_manager")

# Once each time that it falls below, not at each message while it is.
low = Event(level.msg.data < 20.0, on_change=True).as_rule(
    "battery-low", name="Battery low → mark the place"
)
mark = send_srv_request(srv_name=notebook.main_srv_name, srv_type=Trigger)
fresh = Event(Topic(name="/battery/changed", msg_type="Empty")).as_rule(
    "battery-changed", name="Battery changed → full again, nothing marked"
)

launcher = Launcher()
launcher.kompass(
    components=[planner, controller, mapper, driver, battery, notebook],
    events_actions={
        low: [LogInfo(msg="the battery is low; this is where"), mark],
        fresh: [Action(battery.changed), Action(notebook.forget)],
    },
    multi_processing=True,
)
launcher.inputs(location=location)
launcher.robot = my_robot
launcher.bringup()
