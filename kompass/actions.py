"""The actions of recipes."""

from kompass.porting import absent_names
from kompass.recipe.action import Action
from kompass.recipe.service_classes import make_services_instantiable
from kompass.recipe.verbs import (
    ComponentActions,
    LogInfo,
    log,
    publish_message,
    reconfigure,
    restart,
    send_action_goal,
    send_component_action_server_goal,
    send_srv_request,
    start,
    stop,
    trigger_action_server,
    trigger_component_action_server,
    trigger_service,
    update_parameter,
    update_parameters,
)

make_services_instantiable()

__all__ = [
    "Action",
    "ComponentActions",
    "LogInfo",
    "log",
    "publish_message",
    "reconfigure",
    "restart",
    "send_action_goal",
    "send_component_action_server_goal",
    "send_srv_request",
    "start",
    "stop",
    "trigger_action_server",
    "trigger_component_action_server",
    "trigger_service",
    "update_parameter",
    "update_parameters",
]

__getattr__ = absent_names("kompass.actions")
