"""The messages, services and actions that the project adds, from their definitions."""

from __future__ import annotations

from pathlib import Path

INTRODUCTION = """# Messages and services

The ROS 2 interfaces that come with the project. `automatika_ros_sugar`, `nav2_msgs`, `tf2_msgs` and `vision_msgs` hold
what other packages of those names define, as far as it is needed here, so that no ROS installation is.
Where a ROS installation has one of these packages, the definitions agree on the wire.

## Who offers what

| name | type | offered by |
|---|---|---|
| `/<component>/status`, `/<component>_status` | `automatika_ros_sugar/msg/ComponentStatus` | each component; latched, sent on change and at `status_rate` |
| `/<component>/execute_method`, `…/update_config_parameter`, `…/update_config_parameters`, `…/configure_from_file`, `…/change_topic` | `automatika_ros_sugar/srv/…` | each component |
| `/<component>/signed_call` | `kompass_interfaces/srv/SignedCall`: those services, and `change_state`, for who has the [robot's key](../security.md#requests-are-signed) | each component |
| `/<component>/challenge`, `/monitor/challenge` | `std_msgs/msg/String`: what a proof is made for; latched, exchanged every minute | each component, the monitor |
| `/planner/plan_path` | action `kompass_interfaces/action/PlanPath` | a planner whose run type is `ActionServer` |
| `/controller/control_path` | action `kompass_interfaces/action/ControlPath` | the controller, while its algorithm follows paths |
| `/controller/track_vision_target`, `/track_vision_target`, `/controller/end_vision_tracking` | action `kompass_interfaces/action/TrackVisionTarget`, `kompass_interfaces/srv/StopVisionTracking` | the controller, while its algorithm follows targets |
| `/monitor/get_rules`, `check_rules`, `apply_rules`, `confirm_rules`, `rollback_rules`, `explain_rule`, `get_history`, `get_firings`, `reset_rule`, `describe_graph`, `save_recording`, `change_places`, `change_missions`, `change_zones` | `kompass_interfaces/srv/…` | the monitor |
| `/monitor/backtest_rules` | action `kompass_interfaces/action/BacktestRules` | the monitor |
| `/monitor/places` | `std_msgs/msg/String`: all named places, as JSON; latched | the monitor |
| `/monitor/zones`, `/zones` | `std_msgs/msg/String`: all zones, and those that are in force, as JSON; latched | the monitor |
| `/monitor/firings`, `/monitor/rules_state`, `/monitor/stack_state` | `kompass_interfaces/msg/…` | the monitor |
"""  # noqa: E501 - a row of a table is one line
KINDS = (("msg", "Messages"), ("srv", "Services"), ("action", "Actions"))


def interfaces_page(folder: Path) -> str:
    """Each interface with its definition, comments and all.

    Parameters
    ----------
    folder
        Holds a folder for each ROS package.
    """
    parts = [INTRODUCTION]
    for package in sorted(path for path in folder.iterdir() if path.is_dir()):
        parts.append(f"## {package.name}\n")
        for kind, title in KINDS:
            files = sorted((package / kind).glob(f"*.{kind}"))
            if files:
                parts.append(f"### {title} of {package.name}\n")
            for file in files:
                parts.append(f"#### {package.name}/{kind}/{file.stem}\n")
                parts.append(f"```text\n{file.read_text(encoding='utf-8').strip()}\n```\n")
    return "\n".join(parts)
