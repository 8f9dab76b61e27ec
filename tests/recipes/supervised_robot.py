"""For tests: the four components, a rule that answers each failure of the mapper, and a fallback.

The mapper has a scan topic of its own, so that it alone can be made blind.
"""

import numpy as np
from automatika_ros_sugar.msg import ComponentStatus

from kompass.actions import Action, update_parameter
from kompass.components import Controller, DriveManager, LocalMapper, Planner
from kompass.robot import (
    AngularCtrlLimits,
    LinearCtrlLimits,
    RobotConfig,
    RobotGeometry,
    RobotType,
)
from kompass.ros import Event, Launcher, Topic

planner = Planner(component_name="planner")
planner.run_type = "ActionServer"
planner.on_component_fail(Action(planner.restart))
controller = Controller(component_name="controller")
mapper = LocalMapper(component_name="mapper")
driver = DriveManager(component_name="drive_manager")

mapper_fault = Event(mapper.status_topic.msg.status != ComponentStatus.STATUS_HEALTHY, True)
use_the_scan = update_parameter(
    component=controller, param_name="use_direct_sensor", new_value=True
)

launcher = Launcher()
launcher.kompass(
    components=[planner, controller, mapper, driver], events_actions={mapper_fault: use_the_scan}
)
launcher.inputs(location=Topic(name="/odometry/filtered", msg_type="Odometry"))
mapper.inputs(sensor_data=Topic(name="/scan_of_the_mapper", msg_type="LaserScan"))
launcher.robot = RobotConfig(
    model_type=RobotType.DIFFERENTIAL_DRIVE,
    geometry_type=RobotGeometry.Type.CYLINDER,
    geometry_params=np.array([0.1, 0.3]),
    ctrl_vx_limits=LinearCtrlLimits(max_vel=0.2, max_acc=1.5, max_decel=2.5),
    ctrl_omega_limits=AngularCtrlLimits(max_vel=1.0, max_acc=2.0, max_decel=2.0),
)
launcher.bringup()
