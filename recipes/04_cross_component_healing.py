"""One component fails, and another one helps.

When the local mapper's process dies, nobody publishes its status any more. The monitor then speaks
for it, so the rule below fires all the same: the controller looks at the laser scan itself, and the
robot drives on.

    kompass-console run recipes/04_cross_component_healing.py --sim

Try it: send the robot somewhere, and have the mapper's process killed (or stopped, as one that
hangs) after 20 s:

    ... --sim --fault kill:mapper:20
    ... --sim --fault stop:mapper:20

On a real robot, `kill -9` the process that the terminal calls "mapper".
"""

import numpy as np
from sugar.msg import ComponentStatus

from kompass.actions import LogInfo, update_parameter
from kompass.components import Controller, DriveManager, LocalMapper, Planner, PlannerConfig
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

planner = Planner(component_name="planner", config=PlannerConfig(goals_from_topics=True))
planner.run_type = "ActionServer"
planner.inputs(
    goal_point=[
        Topic(name="/goal_pose", msg_type="PoseStamped"),
        Topic(name="/clicked_point", msg_type="PointStamped"),
    ]
)

# The controller avoids obstacles with what the mapper gives it ...
controller = Controller(component_name="controller")
controller.direct_sensor = False
mapper = LocalMapper(component_name="mapper")
driver = DriveManager(component_name="drive_manager")

# ... and when the mapper is not well, for whatever reason, with the scan itself. Once is enough, so
# once must not be wasted: on a busy machine a mapper may be late for some tenths of a second, and
# is well again. `hold` waits until it has not been well for half a second: its process is gone.
mapper_is_not_well = Event(
    mapper.status_topic.msg.status != ComponentStatus.STATUS_HEALTHY, handle_once=True
).as_rule("mapper-lost", hold=0.5, name="Mapper lost → drive by the scan")
look_yourself = update_parameter(
    component=controller, param_name="use_direct_sensor", new_value=True
)

launcher = Launcher()
launcher.kompass(
    components=[planner, controller, mapper, driver],
    events_actions={
        mapper_is_not_well: [LogInfo(msg="no local map: driving by the scan"), look_yourself]
    },
    multi_processing=True,
)
launcher.inputs(location=Topic(name="/odometry/filtered", msg_type="Odometry"))
launcher.robot = my_robot
launcher.bringup()
