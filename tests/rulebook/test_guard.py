"""Guard rails: what nobody may do to the rules of a running robot."""

from typing import Any

import pytest

from kompass.rulebook.guard import guard
from kompass.rulebook.permissions import Permissions
from kompass.rulebook.schema.report import Finding
from kompass.rulebook.sources import with_sources
from kompass.rules.checks.catalog import ComponentSpec
from kompass.rules.schema.actions import (
    Action,
    CallService,
    Lifecycle,
    Log,
    Method,
    Publish,
    Python,
    Reconfigure,
    UpdateParameters,
)
from kompass.rules.schema.conditions import CallableCondition
from kompass.rules.schema.table import Rule, Table
from tests.rules.building import compare, rule

UNBLOCK = Method(component="drive_manager", method="move_to_unblock")


def own(rule_id: str, *actions: Action, **fields: Any) -> Rule:
    condition = fields.pop("condition", compare("a", "<", 1))
    return rule(condition, rule_id, actions=actions or (Log(text="!"),), **fields)


def safety(**fields: Any) -> Rule:
    return own("safety", UNBLOCK, protected=True, source="recipe", **fields)


def recipe() -> Table:
    return Table(rules=(safety(), own("plain", source="recipe")))


def found(
    before: Table | tuple[Rule, ...], after: tuple[Rule, ...], role: str = "operator"
) -> list[Finding]:
    table = before if isinstance(before, Table) else Table(rules=before)
    given = with_sources(Table(rules=after), recipe(), role, (table,))
    return guard(
        table, given, role=role, recipe_table=recipe(), permissions=Permissions({}, recipe())
    )


def codes(*args: Any, **kwargs: Any) -> list[str]:
    findings = found(*args, **kwargs)
    assert all(f.level == "error" and f.text and f.remedy for f in findings)
    return [finding.code for finding in findings]


# -- roles ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("role", ["viewer", "", "root", "Operator"])
def test_who_is_no_operator_changes_nothing(role: str) -> None:
    assert codes(recipe(), (*recipe().rules, own("new")), role=role) == ["role"]
    assert codes(recipe(), recipe().rules, role=role) == []


@pytest.mark.parametrize("role", ["operator", "engineer"])
def test_what_is_not_protected_may_be_changed_disabled_moved_and_removed(role: str) -> None:
    kept, plain = recipe().rules
    for rules in (
        (kept, plain, own("new")),
        (kept, plain.model_copy(update={"enabled": False, "shadow": True})),
        (plain, kept),
        (kept,),
        (kept, own("plain", cooldown=3.0)),
    ):
        assert codes(recipe(), rules, role=role) == []


# -- protected rules ------------------------------------------------------------------------------


@pytest.mark.parametrize("role", ["operator", "engineer"])
@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"enabled": False}, "enabled"),
        ({"shadow": True}, "shadow"),
        ({"severity": "info"}, "severity"),
        ({"lane": "safety"}, "lane"),
        ({"actions": (Log(text="!"),)}, "actions[0]"),
        ({"event": own("x", cooldown=99.0).event}, "event.cooldown"),
    ],
)
def test_a_protected_rule_of_the_recipe_stays_as_it_is(
    role: str, change: dict[str, Any], field: str
) -> None:
    kept, plain = recipe().rules
    changed = Rule.model_validate({**dict(kept), **change})
    (finding,) = found(recipe(), (changed, plain), role)
    assert (finding.code, finding.rule_id, finding.field) == ("protected", "safety", field)


def test_it_may_get_another_name_and_a_note() -> None:
    kept, plain = recipe().rules
    named = kept.model_copy(update={"name": "Keep clear", "note": "ask Ava"})
    assert codes(recipe(), (named, plain)) == []


@pytest.mark.parametrize("role", ["operator", "engineer"])
def test_it_can_be_neither_removed_nor_unprotected(role: str) -> None:
    kept, plain = recipe().rules
    assert codes(recipe(), (plain,), role=role) == ["protected"]
    bare = kept.model_copy(update={"protected": False})
    assert codes(recipe(), (bare, plain), role=role) == ["protected-flag"]


@pytest.mark.parametrize("role", ["operator", "engineer"])
def test_the_flag_of_other_rules_of_the_recipe_is_not_for_people(role: str) -> None:
    kept, plain = recipe().rules
    raised = plain.model_copy(update={"protected": True})
    assert codes(recipe(), (kept, raised), role=role) == ["protected-flag"]


def test_an_engineer_may_protect_an_own_rule_and_only_an_engineer_frees_it() -> None:
    mine = own("mine")
    shielded = mine.model_copy(update={"protected": True})
    rules = recipe().rules
    assert codes((*rules, mine), (*rules, shielded), role="operator") == ["protected-flag"]
    assert codes((*rules, mine), (*rules, shielded), role="engineer") == []
    before = (*rules, shielded)
    assert codes(before, (*rules, mine), role="operator") == ["protected-flag"]
    assert codes(before, (*rules, mine), role="engineer") == []
    changed = own("mine", cooldown=5.0, protected=True)
    assert codes(before, (*rules, changed), role="engineer") == ["protected"]
    assert codes(before, rules, role="engineer") == ["protected"]


@pytest.mark.parametrize("severity", ["warning", "error", "critical"])
def test_it_cannot_be_outranked(severity: str) -> None:
    """Nobody takes its component away, by severity or by standing in front of it."""
    rival = own("rival", UNBLOCK, severity=severity)
    rules = recipe().rules
    assert codes(recipe(), (rival, *rules)) == ["outranks-protected"]
    behind = codes(recipe(), (*rules, rival))
    assert behind == ([] if severity == "warning" else ["outranks-protected"])
    elsewhere = own("rival", Lifecycle(component="planner", action="restart"), severity=severity)
    assert codes(recipe(), (elsewhere, *rules)) == []


def test_what_stood_in_front_of_it_before_may_stay_there() -> None:
    rival = own("rival", UNBLOCK)
    before = (rival, *recipe().rules)
    assert codes(before, (rival.model_copy(update={"note": "old"}), *recipe().rules)) == []


def test_a_protected_rule_that_the_table_in_force_lacks_may_come_back() -> None:
    kept, plain = recipe().rules
    assert codes((plain,), (kept, plain)) == []
    weaker = kept.model_copy(update={"enabled": False})
    assert codes((plain,), (weaker, plain)) == ["protected"]


# -- what no rule may do --------------------------------------------------------------------------


@pytest.mark.parametrize("role", ["operator", "engineer"])
@pytest.mark.parametrize(
    ("action", "code"),
    [
        (
            CallService(service="/release", type="kompass_interfaces/srv/ReleaseStop"),
            "resumes-after-stop",
        ),
        (CallService(service="ns/x/release_stop", type="p/srv/X"), "resumes-after-stop"),
        (Method(component="drive_manager", method="release_stop"), "resumes-after-stop"),
        (Publish(topic="cmd_vel", type="geometry_msgs/msg/Twist"), "bypasses-gate"),
        (Publish(topic="other", type="geometry_msgs/msg/TwistStamped"), "bypasses-gate"),
        (Lifecycle(component="drive_manager", action="stop"), "opens-gate"),
        (Method(component="drive_manager", method="stop"), "opens-gate"),
        (Reconfigure(component="drive_manager", config="x.yaml"), "opens-gate"),
        (
            Method(
                component="drive_manager",
                method="set_param",
                kwargs={"param_name": "disable_safety_stop", "new_value": True},
            ),
            "opens-gate",
        ),
        (
            UpdateParameters(component="drive_manager", parameters={"disable_safety_stop": True}),
            "opens-gate",
        ),
        (
            UpdateParameters(
                component="drive_manager", parameters={"critical_zone_distance": 0.001}
            ),
            "opens-gate",
        ),
        (
            UpdateParameters(component="drive_manager", parameters={"robot.radius": 0.01}),
            "opens-gate",
        ),
        (UpdateParameters(component="drive_manager", parameters={"loop_rate": 1.0}), "opens-gate"),
        (
            CallService(service="/drive_manager/update_config_parameter", type="p/srv/X"),
            "opens-gate",
        ),
        (CallService(service="drive_manager/change_state", type="p/srv/X"), "opens-gate"),
        (Python(name="os.system"), "foreign-function"),
    ],
)
def test_no_rule_resumes_motion_or_opens_the_gate(role: str, action: Action, code: str) -> None:
    assert codes(recipe(), (*recipe().rules, own("new", action)), role=role) == [code]
    # Nor does one that was there already, as of a revision of the past.
    before = (*recipe().rules, own("old", action))
    assert code in codes(before, before, role=role)


@pytest.mark.parametrize(
    "action",
    [
        UNBLOCK,
        Lifecycle(component="drive_manager", action="restart"),
        Lifecycle(component="controller", action="stop"),
        UpdateParameters(component="controller", parameters={"scan_timeout": 1.0}),
        CallService(service="/drive_manager/stop", type="kompass_interfaces/srv/StopRobot"),
    ],
)
def test_what_is_harmless_passes(action: Action) -> None:
    assert codes(recipe(), (*recipe().rules, own("new", action))) == []


def test_the_recipe_itself_may_do_what_people_may_not_and_its_timing_may_be_edited() -> None:
    stops = Lifecycle(component="drive_manager", action="stop")
    declared = own("night", stops, Python(name="shout"), source="recipe")
    declares = Table(rules=(declared,))

    def codes_of(after: Rule) -> list[str]:
        table = Table(rules=(after,))
        found = guard(
            declares,
            with_sources(table, declares, "operator"),
            role="operator",
            recipe_table=declares,
            permissions=Permissions({}, declares),
        )
        return [finding.code for finding in found]

    slower = Lifecycle(component="drive_manager", action="stop", timeout=60.0)
    assert codes_of(own("night", stops, Python(name="shout"), cooldown=9.0)) == []
    assert codes_of(own("night", slower, Python(name="shout"), cooldown=9.0)) == []
    assert codes_of(own("night", stops, cooldown=9.0)) == ["opens-gate"]
    other = compare("a", "<", 2)
    assert codes_of(own("night", stops, Python(name="shout"), condition=other)) == ["opens-gate"]
    assert codes_of(own("copied", stops)) == ["opens-gate"]
    assert codes_of(own("copied", Python(name="shout"))) == []


def test_only_functions_of_the_recipe_can_be_asked() -> None:
    asked = own("new", condition=CallableCondition(name="anything", rate=1.0))
    assert codes(recipe(), (*recipe().rules, asked)) == ["foreign-function"]


def test_the_gate_is_known_by_what_it_is_and_not_only_by_its_name() -> None:
    wheels = ComponentSpec("wheels", gate=True, hears=frozenset({"bumper"}))
    permissions = Permissions({"wheels": wheels, "x": ComponentSpec("x")}, Table())
    for action in (
        Lifecycle(component="wheels", action="stop"),
        Publish(topic="/bumper", type="std_msgs/msg/Bool"),
    ):
        after = Table(rules=(own("new", action, source="engineer"),))
        (finding,) = guard(
            Table(), after, role="engineer", recipe_table=Table(), permissions=permissions
        )
        assert finding.code in ("opens-gate", "bypasses-gate")


@pytest.mark.parametrize("role", ["operator", "engineer"])
@pytest.mark.parametrize("word", ["start", "restart", "configure"])
def test_nobody_starts_again_what_a_protected_rule_stops(role: str, word: str) -> None:
    stops = own("halt", Lifecycle(component="controller", action="stop"), protected=True)
    stops = stops.model_copy(update={"source": "recipe"})
    declares = Table(rules=(stops,))
    for action in (
        Lifecycle.model_validate({"component": "controller", "action": word}),
        Method(component="controller", method=word),
    ):
        after = Table(rules=(stops, own("again", action)))
        (finding,) = guard(
            declares,
            with_sources(after, declares, role),
            role=role,
            recipe_table=declares,
            permissions=Permissions({}, declares),
        )
        assert (finding.code, finding.rule_id) == ("undoes-protected", "again")
