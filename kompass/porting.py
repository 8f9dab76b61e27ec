"""Names of Kompass and Sugarcoat that are not here, and what takes their place.

A recipe or component written for these packages gets its answer at the import, in one line. What
is here under another name, or in another module, is in ``kompass/compat``.
"""

import difflib
import sys
from collections.abc import Callable, Sequence
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec, PathFinder
from types import ModuleType
from typing import Any

PAGE = "docs/porting.md"
LIKENESS = 0.8  # of a name to one that is here, for it to be a slip of the same

CAMERA = "a detector of yours publishes vision_msgs/Detection2DArray; see ControllersID.VISION_IMG"
SETTINGS = "derive from kompass.config.Settings, whose fields are pydantic's"
BOUNDS = "give bounds with pydantic, x: float = Field(default=1.0, ge=0, le=10)"
MESSAGES = (
    "self.callbacks[key] of a component says what came; self.attach_custom_callback(key, f) calls f"
)
PUBLISHING = "self.publishers_dict[key].publish(value) of a component takes plain values, too"
IN_COMPONENT = "call it on the node, as any ROS client; self.node is one"
PLUGINS = "connect the robot's own topics with launcher.inputs(…) and launcher.outputs(…)"
PROCESSES = "Launcher.bringup() starts the processes; a component needs no executable"
UI = "the page comes with `kompass-console run <recipe>`"
LAUNCH = (
    "use kompass.actions.LogInfo(msg=…) to log, kompass.actions.stop(component=…) to stop; "
    "bringup() launches, without ROS 2 Launch"
)
RECORDER = "`kompass-console run` records what the robot does; see docs/recorder.md"

IN_COMPONENTS = "import it from kompass.components"
EVENT = "use Event on the topic of what happens, e.g. component.status_topic"

NAMES: dict[str, dict[str, str]] = {
    "kompass.actions": {
        "trigger_component_service": "use trigger_service(srv_name=…, srv_type=…)",
        "send_component_service_request": "use send_srv_request(srv_name=…, srv_type=…)",
        "send_component_action_goal": "use send_component_action_server_goal(component=…)",
    },
    "kompass.event": {
        "InternalEvent": EVENT,
        "OnInternalEvent": EVENT,
    },
    "kompass.ros": {
        "Publisher": PUBLISHING,
        "GenericCallback": MESSAGES,
    },
    "kompass.config": {
        "BaseAttrs": SETTINGS,
        "BaseConfig": SETTINGS,
        "BaseValidators": BOUNDS,
        "base_validators": BOUNDS,
    },
    "kompass.components": {},
    "kompass.components.controller": {
        **dict.fromkeys(("Controller", "ControllerConfig"), IN_COMPONENTS),
        "ControllersID": "import it from kompass.control",
        "CmdPublishType": "give the name: ControllerConfig(ctrl_publish_type='Parallel')",
    },
    "kompass.components.planner": dict.fromkeys(("Planner", "PlannerConfig"), IN_COMPONENTS),
    "kompass.control": {},
    "kompass.robot": {
        "Robot": "use RobotConfig of kompass.robot",
        "RobotState": "a pose is (x, y, yaw); see kompass.algorithms.geometry",
    },
    "ros_sugar": {
        "UINode": UI,
    },
    "ros_sugar.core": {
        "Fallback": "use component.on_fail(action, max_retries=…), on_algorithm_fail, …",
        "ComponentFallbacks": "use component.on_fail(action, max_retries=…), on_algorithm_fail, …",
        "Status": "use self.health of the component: set_healthy(), set_fail_algorithm([…], text)",
        "Monitor": "use Launcher(enable_monitoring=True), which runs the monitor",
        "Routine": "use a list of actions: {event: [first, second]}",
        "RoutineStatus": "use a list of actions: {event: [first, second]}",
        "ActionOutcome": "return True or False from the action; firings are on /monitor/firings",
        "ActionServerGoal": "use kompass.actions.send_action_goal(action_name=…)",
        "SystemActionRegistry": "use launcher.open_to_rules(…)",
        "RegisteredAction": "use @component_action, and rules may call it",
        "RegisteredEvent": "use Event",
        "InternalEvent": EVENT,
        "OnInternalEvent": EVENT,
    },
    "ros_sugar.io": {
        "Publisher": PUBLISHING,
        "GenericCallback": MESSAGES,
        "get_all_msg_types": "use any ROS message type: Topic(msg_type='package/Type')",
        "get_msg_type": "use Topic(…).ros_msg_type",
        "LaserScanData": MESSAGES,
        "PointCloudData": MESSAGES,
        "supported_types": "use any ROS message type: Topic(msg_type='package/Type')",
    },
    "ros_sugar.config": {
        "BaseAttrs": SETTINGS,
        "BaseConfig": SETTINGS,
        "BaseValidators": BOUNDS,
        "base_validators": BOUNDS,
    },
    "ros_sugar.utils": {
        "component_fallback": "use @component_action; a fallback may be any of these",
        "action_handler": "use kompass.actions.Action(method)",
        "launch_action": LAUNCH,
        "log_srv": "nothing is to be marked; calls of services are logged",
        "IncompatibleSetup": "catch ValueError and TypeError",
        "InvalidAction": "catch ValueError and TypeError",
        "logger": "use kompass.ros.logger",
    },
    "kompass_core.control": {
        "VisionRGBFollower": (
            "its settings are VisionRGBFollowerConfig; ControllersID.VISION_IMG chooses it"
        ),
        "VisionRGBDFollower": (
            "its settings are VisionRGBDFollowerConfig; ControllersID.VISION_DEPTH chooses it"
        ),
        "DVZ": "its settings are DVZConfig of kompass.control; ControllersID.DVZ chooses it",
    },
    "kompass_core.models": {
        "Robot": "use RobotConfig of kompass.robot",
        "RobotState": "a pose is (x, y, yaw); see kompass.algorithms.geometry",
    },
}

MODULES: dict[str, str] = {
    "kompass.utils": "use kompass.config.Settings, and kompass.algorithms.geometry for poses",
    "kompass.cli": "the command is kompass-console; its help lists what it does",
    "kompass.callbacks": MESSAGES,
    "kompass.components.drive_manager": "import DriveManager from kompass.components",
    "kompass.components.mapper": "import LocalMapper from kompass.components",
    "kompass.components.map_server": "import MapServer from kompass.components",
    "kompass.components.motion_server": "import MotionServer from kompass.components",
    "kompass.data_types": "use any ROS message type: Topic(msg_type='package/Type')",
    "kompass.executable": PROCESSES,
    "ros_sugar.base_clients": "use ServiceClientConfig, ActionClientConfig of kompass.ros",
    "ros_sugar.condition": "use topic.msg.field > 1 as the condition of an Event",
    "ros_sugar.launch": "use kompass.ros.Launcher; actions are in kompass.actions",
    "ros_sugar.recording": RECORDER,
    "ros_sugar.robot": PLUGINS,
    "ros_sugar.tf": "self.frames of a component names the frames that it looks up",
    "ros_sugar.ui_node": UI,
    "kompass_core.algorithms": "use kompass.algorithms",
    "kompass_core.datatypes": MESSAGES,
    "kompass_core.mapping": "use kompass.algorithms.mapping, set with MapConfig of kompass.control",
    "kompass_core.performance": "benchmarks/ measures what there is here",
    "kompass_core.third_party": "use PlannerConfig(planner_id=…) for the planners of OMPL",
    "kompass_core.utils": "use kompass.algorithms.geometry",
    "kompass_core.vision": CAMERA,
    "kompass_cpp": "use kompass.algorithms, whose parts take and give NumPy arrays",
    "launch": LAUNCH,
    "launch_ros": LAUNCH,
}


class NotHere(ModuleNotFoundError):
    """A name of the original packages that is not here; the text names what is."""


def not_here(name: str, instead: str) -> NotHere:
    """The error for a name: what it is, and what to do."""
    # Without its name: an import of a list would pass over one that says whose it is.
    return NotHere(f"{name} is not here: {instead} ({PAGE})")


def absent_names(module: str) -> Callable[[str], Any]:
    """The ``__getattr__`` of a module of this name, which lacks names of the original one.

    A name that is nearly one of the module's is answered with that one.
    """
    table = NAMES[module]

    def missing(name: str) -> Any:
        # ``from … import`` drops the text of an AttributeError.
        if name in table:
            raise not_here(f"{module}.{name}", table[name])
        here = sys.modules[module]
        # A package is asked for its modules, too, before they are looked for.
        if not name.startswith("_") and not _is_module(here, name):
            near = difflib.get_close_matches(name, getattr(here, "__all__", ()), 1, LIKENESS)
            if near:
                raise not_here(f"{module}.{name}", f"did you mean '{near[0]}'?")
        raise AttributeError(f"module {module!r} has no attribute {name!r}")

    return missing


def _is_module(package: ModuleType, name: str) -> bool:
    folders = getattr(package, "__path__", None)
    return folders is not None and bool(PathFinder.find_spec(f"{package.__name__}.{name}", folders))


class AbsentModules(MetaPathFinder):
    """Asked last, when there is no such module: says what takes the place of an original one."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """None for a module that is nobody's; for an original one, :class:`NotHere`."""
        instead = MODULES.get(fullname)
        if instead is not None:
            raise not_here(fullname, instead)
        return None


def answer_absent_modules() -> None:
    """Answer imports of original modules from now on, once in a process."""
    if not any(isinstance(each, AbsentModules) for each in sys.meta_path):
        sys.meta_path.append(AbsentModules())
