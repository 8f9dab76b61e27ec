"""What recipes and components of one's own may use: these names, and no fewer."""

import pytest

from kompass.components import (
    Component,
    Controller,
    DriveManager,
    LocalMapper,
    MapServer,
    MotionServer,
    Planner,
)

OF_ALL = """
action_specs action_type add_callback_postprocessor add_publisher_preprocessor
allowed_inputs allowed_outputs allowed_run_types answer_call apply_config_file asks_for_motion
attach_custom_callback
available_actions awaits broadcast_status call_action callbacks check_declaration clock
config_class
create_interfaces create_node create_timer
custom_on_activate custom_on_cleanup custom_on_configure custom_on_deactivate custom_on_error
custom_on_shutdown default_inputs default_outputs destroy_timer fails frames get_in_topic get_logger
get_missing_inputs get_out_topic got_all_inputs health_status ignored_inputs
ignored_settings in_topic_name init_variables input inputs inputs_keys is_active is_starting
lacks_robot leave
lifecycle_state longest_step loop_rate main_action_callback main_action_name main_action_type
main_service_callback main_srv_name main_srv_type needs_robot node on_activate
on_algorithm_fail
on_callback_error on_cleanup on_component_fail on_config_changed on_configure on_deactivate on_fail
on_feeder_lost on_giveup on_hook_done on_hook_error on_shutdown on_system_fail on_transition_error
open_to_recipe out_topic_name outputs outputs_keys publish publish_status publishers_dict qos
reconfigure replace_topic restart robot run_type safe_restart serves_main_action_itself service_type
set_input set_output set_param set_params settings_of_file sleep start status_topic
steps_in_any_run_type stop stops_robot tells_missing_inputs ui_main_action_input wants_input warn
"""
OF_AN_OBJECT = "action_problem config fallbacks health node_name on_intent"
OWN = {
    Component: "",
    Planner: "clear_obstacles replan trigger_main_action_server wait_for_way",
    Controller: "algorithm algorithms_config direct_sensor set_algorithm",
    LocalMapper: "",
    DriveManager: (
        "back_off drive_leg end_leg move_backward move_forward move_to_unblock room_for "
        "rotate_in_place turn_to_room"
    ),
    MapServer: "",
    MotionServer: "run_test",
}


def public(names: object) -> set[str]:
    return {name for name in dir(names) if not name.startswith("_")}


@pytest.mark.parametrize("kind", OWN, ids=lambda kind: kind.__name__)
def test_a_component_has_these_public_names(kind: type[Component]) -> None:
    of_class = set(OF_ALL.split()) | set(OWN[kind].split())
    assert public(kind) == of_class
    assert public(kind("some_name")) == of_class | set(OF_AN_OBJECT.split())


def test_the_step_of_the_main_loop_is_overridden_under_its_known_name() -> None:
    assert all(hasattr(kind, "_execution_step") for kind in OWN)
