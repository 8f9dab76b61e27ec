"""Services under an older import name."""

from automatika_ros_sugar.srv import (
    ChangeParameter,
    ChangeParameters,
    ConfigureFromFile,
    ExecuteMethod,
    ReplaceTopic,
)

__all__ = [
    "ChangeParameter",
    "ChangeParameters",
    "ConfigureFromFile",
    "ExecuteMethod",
    "ReplaceTopic",
]
