"""A robot that follows who a camera sees, with the algorithm that the environment names."""

import os

from kompass.bench.stack import described
from kompass.components import Controller, ControllerConfig, DriveManager, LocalMapper, Planner
from kompass.control import VisionRGBDFollowerConfig
from kompass.launcher import Launcher
from kompass.ros import Topic
from kompass.simulation.physics.robot_model import TURTLEBOT3

planner = Planner(component_name="planner")
planner.run_type = "ActionServer"
controller = Controller(config=ControllerConfig(patience=8.0))
controller.inputs(
    vision_detections=Topic(name="/detections", msg_type="Detection2DArray"),
    depth_camera_info=Topic(name="/camera/camera_info", msg_type="CameraInfo"),
    depth_image=Topic(name="/camera/depth", msg_type="Image"),
)
controller.algorithm = os.environ["FOLLOWER"]
controller.algorithms_config = VisionRGBDFollowerConfig(target_distance=0.7)
driver = DriveManager(component_name="drive_manager")
driver.outputs(robot_command=Topic(name="/cmd_vel", msg_type="Twist"))

launcher = Launcher()
launcher.kompass(
    components=[planner, controller, LocalMapper(component_name="mapper"), driver],
    multi_processing=True,
)
launcher.inputs(location=Topic(name="/odometry/filtered", msg_type="Odometry"))
launcher.robot = described(TURTLEBOT3)
launcher.bringup()
