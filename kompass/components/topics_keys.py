"""The keys of inputs and outputs, as older recipes name them."""

import enum


class TopicsKeys(enum.StrEnum):
    """A key stands for its text: ``component.get_out_topic(TopicsKeys.EMERGENCY)``."""

    GOAL_POINT = "goal_point"
    GLOBAL_PLAN = "plan"
    GLOBAL_MAP = "map"
    ROBOT_LOCATION = "location"
    SPATIAL_SENSOR = "sensor_data"
    VISION_DETECTIONS = "vision_detections"
    DEPTH_CAM_INFO = "depth_camera_info"
    INTERMEDIATE_CMD = "command"
    INTERMEDIATE_CMD_LIST = "multi_command"
    LOCAL_MAP = "local_map"
    LOCAL_MAP_OCC = "local_map"
    TRACKED_POINT = "tracked_point"
    FINAL_COMMAND = "robot_command"
    EMERGENCY = "emergency_stop"
    REACHED_END = "reached_end"
