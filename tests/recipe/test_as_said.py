"""What a recipe says is what its rules do: nothing is lost, mixed up, or read as something else."""

import functools
import math
from collections.abc import Callable
from typing import Any

import pytest
from std_msgs.msg import Float64, String
from std_srvs.srv import SetBool

from kompass import event
from kompass.actions import (
    Action,
    LogInfo,
    log,
    publish_message,
    reconfigure,
    send_srv_request,
    trigger_service,
)
from kompass.components import DriveManager, Planner
from kompass.launch.failure_policies import FailurePolicies
from kompass.monitor.introspection.catalog import RecipeCatalog
from kompass.monitor.tables.recipe_check import check_recipe
from kompass.rclpy_ext.topic import Topic
from kompass.recipe.fallbacks import FallbackSequence
from kompass.recipe.parsed import Parsed
from kompass.recipe.table import RecipeRules, recipe_rules
from kompass.ros import Event, Launcher
from kompass.rules.schema.actions import CallService, Publish, Python, SendGoal
from kompass.rules.schema.arguments import resolve
from kompass.rules.schema.conditions import CallableCondition, Compare

NUMBER = Topic(name="number", msg_type="Float64")
TEXT = Topic(name="text", msg_type="String")
FLAG = Topic(name="flag", msg_type="Bool")
SCAN = Topic(name="scan", msg_type="LaserScan")
PLANNER, DRIVER = Planner(), DriveManager()
COMPONENTS = [PLANNER, DRIVER]


def read(events_actions: Any) -> RecipeRules:
    """The rules of a recipe, which fit the robot."""
    made = recipe_rules(events_actions, COMPONENTS)
    check_recipe(made.table, RecipeCatalog(COMPONENTS, made))
    return made


def near(limit: float) -> Callable[[], bool]:
    def check() -> bool:
        return limit > 1.0

    return check


class Battery:
    def __init__(self, name: str, low: bool) -> None:
        self.name, self._low = name, low

    def is_low(self) -> bool:
        return self._low

    def swap(self) -> str:
        return f"swapped {self.name}"


def polled_answers(made: RecipeRules) -> dict[str, bool]:
    """What each rule's condition answers."""
    answers = {}
    for rule in made.table.rules:
        condition = rule.event.condition
        assert isinstance(condition, CallableCondition)
        answers[rule.id] = bool(made.polled[condition.name]())
    return answers


def answer(low: bool) -> bool:
    return low


# -- functions of one name ------------------------------------------------------------------------


@pytest.mark.parametrize(
    "conditions",
    [
        (lambda: False, lambda: True),
        (near(0.5), near(2.0)),
        (Battery("front", False).is_low, Battery("rear", True).is_low),
        (Battery("same", False).is_low, Battery("same", True).is_low),
        (functools.partial(answer, False), functools.partial(answer, True)),
        (Action(answer, args=(False,)), Action(answer, args=(True,))),
    ],
    ids=["lambdas", "closures", "methods", "methods of namesakes", "partials", "actions"],
)
def test_two_conditions_of_one_name_are_both_asked(conditions: tuple[Any, Any]) -> None:
    made = read({Event(one): LogInfo(msg=str(i)) for i, one in enumerate(conditions)})
    assert list(polled_answers(made).values()) == [False, True]
    assert len({rule.name for rule in made.table.rules}) == 2


@pytest.mark.parametrize(
    ("actions", "results"),
    [
        ((lambda: "one", lambda: "two"), ["one", "two"]),
        ((near(0.5), near(2.0)), [False, True]),
        (
            (Battery("front", False).swap, Battery("rear", True).swap),
            ["swapped front", "swapped rear"],
        ),
    ],
    ids=["lambdas", "closures", "methods"],
)
def test_two_functions_of_one_name_are_both_called(actions: Any, results: list[Any]) -> None:
    made = read({Event(NUMBER): [Action(one) for one in actions]})
    names = [action.name for action in made.table.rules[0].actions if isinstance(action, Python)]
    assert len(set(names)) == 2
    assert [made.functions[name]() for name in names] == results  # type: ignore[operator]


def test_names_tell_people_which_function_is_meant() -> None:
    made = read(
        {
            Event(near(0.5)): LogInfo(msg="a"),
            Event(near(2.0)): LogInfo(msg="b"),
            Event(Battery("front", True).is_low): LogInfo(msg="c"),
            Event(Battery("rear", True).is_low): LogInfo(msg="d"),
        }
    )
    assert list(made.polled) == [
        "check (limit=0.5)",
        "check (limit=2.0)",
        "is_low (front)",
        "is_low (rear)",
    ]
    assert [rule.id for rule in made.table.rules][:2] == ["check-limit-0-5", "check-limit-2-0"]


def test_names_do_not_depend_on_the_order_of_the_recipe() -> None:
    def rules(*limits: float) -> set[str]:
        return set(read({Event(near(limit)): LogInfo(msg="x") for limit in limits}).polled)

    assert rules(0.5, 2.0) == rules(2.0, 0.5)


def test_a_function_that_is_alone_keeps_its_name() -> None:
    low = near(0.5)
    made = read({Event(low): Action(low), Event(low, on_change=True): LogInfo(msg="x")})
    assert (list(made.polled), list(made.functions)) == (["check"], ["check"])


@pytest.mark.parametrize("text", ["$5", "$$", "$msg", "$topic[/odom]", "paid in $msgs"])
def test_a_condition_is_asked_with_the_text_that_it_was_given(text: str) -> None:
    asked: list[str] = []

    def is_paid(text: str) -> bool:
        asked.append(text)
        return True

    made = read({Event(Action(is_paid, args=(text,))): LogInfo(msg="x")})
    (ask,) = made.polled.values()
    assert ask()
    assert asked == [text]


def test_one_function_asked_at_two_rates_is_asked_at_both() -> None:
    low = near(0.5)
    made = read(
        {
            Event(low, check_rate=1.0): LogInfo(msg="slow"),
            Event(low, check_rate=20.0): LogInfo(msg="fast"),
        }
    )
    conditions = [rule.event.condition for rule in made.table.rules]
    assert [(c.name, c.rate) for c in conditions if isinstance(c, CallableCondition)] == [
        ("check (1 Hz)", 1.0),
        ("check (20 Hz)", 20.0),
    ]


# -- one event, several times ---------------------------------------------------------------------


def rules_of(launcher: Launcher) -> RecipeRules:
    return recipe_rules(launcher._events_actions, COMPONENTS)


def test_an_event_given_twice_has_the_actions_of_both_in_order() -> None:
    launcher = Launcher()
    pressed = Event(FLAG.msg.data.is_true())
    launcher.kompass([PLANNER], events_actions={pressed: LogInfo(msg="a")})
    launcher.add_pkg([DRIVER], events_actions={pressed: [LogInfo(msg="b"), LogInfo(msg="c")]})
    launcher.on(pressed, LogInfo(msg="d"))
    (rule,) = rules_of(launcher).table.rules
    assert [action.text for action in rule.actions] == ["a", "b", "c", "d"]  # type: ignore[union-attr]


def test_what_the_recipe_handed_in_is_not_changed_by_more_actions() -> None:
    launcher, pressed = Launcher(), Event(NUMBER)
    own = {pressed: [LogInfo(msg="a")]}
    launcher.kompass([PLANNER], events_actions=own)
    launcher.on(pressed, LogInfo(msg="b"))
    assert len(own[pressed]) == 1


def test_an_event_without_an_action_is_refused() -> None:
    with pytest.raises(ValueError, match=r"has no action; give it one"):
        read({Event(NUMBER): []})


# -- functions that are none, or cannot be called --------------------------------------------------


def steps() -> Any:
    yield 1


async def stream() -> Any:
    yield 1


def needs(what: str) -> bool:
    return bool(what)


@pytest.mark.parametrize(
    ("make", "error", "sentence"),
    [
        (lambda: Action(steps), TypeError, r"steps is a generator.*without yield"),
        (lambda: Event(stream), TypeError, r"stream is a generator.*without yield"),
        (lambda: Event(DRIVER.restart), TypeError, r"drive_manager\.restart.*status_topic"),
        (lambda: Event(Action(DRIVER.restart)), TypeError, r"drive_manager\.restart.*status_topic"),
        (
            lambda: Event(functools.partial(DRIVER.move_forward, 1.0)),
            TypeError,
            r"drive_manager\.move_forward",
        ),
        (
            lambda: Action(functools.partial(DRIVER.move_forward, 1.0)),
            TypeError,
            r"Action\(drive_manager\.move_forward, kwargs=",
        ),
        (lambda: Event(LogInfo(msg="x")), TypeError, r"is an action and no condition"),
        (
            lambda: Event(Action(needs, args=(TEXT.msg.data,))),
            TypeError,
            r"what = \$topic\[/text\]\.data.*no message",
        ),
        (lambda: Event(needs), TypeError, r"needs needs what"),
        (lambda: Action(min), TypeError, r"min does not tell what it takes; wrap it in a function"),
        (lambda: Event(min), TypeError, r"min does not tell what it takes; wrap it in a function"),
    ],
)
def test_what_is_no_function_for_it_is_refused_in_a_sentence(
    make: Callable[[], Any], error: type[Exception], sentence: str
) -> None:
    with pytest.raises(error, match=sentence) as raised:
        make()
    assert "\n" not in str(raised.value)


def test_print_may_be_an_action() -> None:
    made = read({Event(NUMBER): Action(print, args=("a", NUMBER.msg.data), kwargs={"sep": "-"})})
    (action,) = made.table.rules[0].actions
    assert isinstance(action, Python)
    kwargs = resolve(action.kwargs, Float64(data=2.0), {"number": Float64(data=2.0)})
    assert called(made, action, kwargs) is None


def test_print_gets_its_values(capsys: pytest.CaptureFixture[str]) -> None:
    made = read({Event(NUMBER): Action(print, args=("a", "b"), kwargs={"sep": "-"})})
    (action,) = made.table.rules[0].actions
    assert isinstance(action, Python)
    called(made, action, action.kwargs)
    assert capsys.readouterr().out == "a-b\n"


def called(made: RecipeRules, action: Python, kwargs: Any) -> Any:
    return made.functions[action.name](**kwargs)  # type: ignore[operator]


def test_positional_arguments_reach_a_function_by_position() -> None:
    def divide(a: float, b: float, /, *more: float, digits: int = 0) -> Any:
        return a, b, more, digits

    made = read({Event(NUMBER): Action(divide, args=(1.0, 2.0, 3.0, 4.0), kwargs={"digits": 2})})
    (action,) = made.table.rules[0].actions
    assert isinstance(action, Python)
    assert called(made, action, action.kwargs) == (1.0, 2.0, (3.0, 4.0), 2)


# -- values ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "rate", [0, 0.0, -1.0, math.nan, math.inf, True, "2"], ids=lambda rate: repr(rate)
)
def test_a_rate_that_is_none_is_refused(rate: Any) -> None:
    with pytest.raises((ValueError, TypeError), match=r"check_rate = .* Hz above 0"):
        Event(near(1.0), check_rate=rate)


@pytest.mark.parametrize("delay", [math.nan, math.inf, "1"])
def test_a_delay_that_is_none_is_refused(delay: Any) -> None:
    makes: tuple[Callable[[], Any], ...] = (
        lambda: Event(NUMBER, keep_event_delay=delay),
        lambda: event.OnAny("e", NUMBER, keep_event_delay=delay),
    )
    for make in makes:
        with pytest.raises((ValueError, TypeError), match=r"keep_event_delay = .* seconds") as told:
            make()
        assert "\n" not in str(told.value)


@pytest.mark.parametrize(
    "make",
    [
        lambda: NUMBER.msg.data < math.inf,
        lambda: NUMBER.msg.data == math.nan,
        lambda: NUMBER.msg.data.between(-math.inf, 1.0),
        lambda: NUMBER.msg.data.is_in([1.0, math.nan]),
        lambda: SCAN.msg.ranges.contains(math.inf),
    ],
)
def test_a_number_that_is_not_finite_is_refused_in_a_sentence(make: Callable[[], Any]) -> None:
    with pytest.raises(ValueError, match=r"(inf|nan): .*finite number") as told:
        make()
    assert "\n" not in str(told.value)


@pytest.mark.parametrize(
    ("made", "literal"),
    [
        (lambda: FLAG.msg.data == 1, True),
        (lambda: FLAG.msg.data != 0, False),
        (lambda: FLAG.msg.data.is_in([0, 1]), (False, True)),
    ],
)
def test_a_truth_value_may_be_written_as_0_or_1(made: Callable[[], Any], literal: Any) -> None:
    condition = Event(made()).rule_event.condition
    assert isinstance(condition, Compare)
    assert condition.value is literal or condition.value == literal
    assert not isinstance(condition.value, int) or isinstance(condition.value, bool)


def test_a_truth_value_is_no_other_number() -> None:
    with pytest.raises(TypeError, match="truth value"):
        assert FLAG.msg.data == 2


def test_a_value_of_a_topic_may_stand_inside_a_list_or_a_mapping() -> None:
    def go(to: list[float], how: dict[str, Any]) -> None: ...

    action = Action(go, args=([NUMBER.msg.data, 2.0], {"speed": (NUMBER.msg.data,), "for": "$5"}))
    (data,) = read({Event(FLAG): action}).table.rules[0].actions
    assert isinstance(data, Python)
    got = resolve(data.kwargs, None, {"number": Float64(data=7.0)})
    assert got == {"to": [7.0, 2.0], "how": {"speed": [7.0], "for": "$5"}}


def test_a_number_of_an_argument_that_is_not_finite_is_refused_in_a_sentence() -> None:
    def go(to: Any) -> None: ...

    for value in (math.nan, [1.0, math.inf], {"x": -math.inf}):
        with pytest.raises((TypeError, ValueError), match=r"to = .*finite") as told:
            Action(go, args=(value,))
        assert "\n" not in str(told.value)
    with pytest.raises((TypeError, ValueError), match=r"data.*finite") as told:
        publish_message(topic=NUMBER, msg=Float64(data=math.nan))
    assert "\n" not in str(told.value)


@pytest.mark.parametrize("text", ["$msg", "$5", "$$", "$topic[/x].y"])
def test_a_text_that_looks_like_a_reference_is_sent_as_it_is(text: str) -> None:
    published = publish_message(topic=TEXT, msg=String(data=text)).to_data()
    assert isinstance(published, Publish)
    assert resolve(published.message, String(data="wrong"), {}) == {"data": text}


def test_a_request_may_have_a_value_of_a_topic() -> None:
    asked = send_srv_request(
        srv_name="light", srv_type=SetBool, srv_request_msg={"data": FLAG.msg.data}
    ).to_data()
    assert isinstance(asked, CallService)
    assert asked.request == {"data": "$topic[/flag].data"}


def test_a_configuration_is_data() -> None:
    with pytest.raises((TypeError, ValueError), match=r"loop_rate.*finite"):
        reconfigure(component=PLANNER, new_config={"loop_rate": math.nan})


# -- fallbacks ------------------------------------------------------------------------------------


def honk() -> None: ...


def fallback_of(driver: DriveManager) -> tuple[RecipeRules, FallbackSequence]:
    made = recipe_rules({}, [driver])
    check_recipe(made.table, RecipeCatalog([driver], made))
    (found,) = (one for one in made.functions.values() if isinstance(one, FallbackSequence))
    return made, found


@pytest.mark.parametrize("action", [honk, Action(honk), lambda: None])
def test_a_plain_function_is_a_fallback(action: Any) -> None:
    driver = DriveManager()
    driver.on_fail(action)
    made, found = fallback_of(driver)
    tried = found.next()
    assert isinstance(tried, Python)
    assert callable(made.functions[tried.name])


def test_an_action_that_a_parser_makes_is_a_fallback() -> None:
    driver = DriveManager()
    driver.on_system_fail(trigger_service(srv_name="/light", srv_type=SetBool))
    made, found = fallback_of(driver)
    tried = found.next()
    assert isinstance(tried, Python)
    assert isinstance(made.functions[tried.name], Parsed)


def test_what_a_fallback_lacks_is_told_when_the_recipe_is_read() -> None:
    driver = DriveManager()
    driver.on_fail(Action(driver.move_forward))
    with pytest.raises(ValueError, match=r"on_fail.* lacks max_distance"):
        recipe_rules({}, [driver])


def test_a_fallback_may_take_a_value_of_a_topic() -> None:
    driver = DriveManager()
    driver.on_fail(Action(driver.move_forward, args=(NUMBER.msg.data,)))
    made, _ = fallback_of(driver)
    rule = next(each for each in made.table.rules if each.id == "drive-manager-on-fail")
    from kompass.rules.engine.compiled_table import compile_table

    assert "number" in compile_table(made.table).topic_types(), rule


def test_a_policy_of_the_launcher_that_fits_nobody_is_refused() -> None:
    policies = FailurePolicies()
    policies.add("on_fail", "move_to_unblok", None, [])
    with pytest.raises(ValueError, match="no component has an action 'move_to_unblok'"):
        policies.apply([DRIVER, PLANNER])


# -- names of older events -------------------------------------------------------------------------

E = Event(NUMBER.msg.data > 1.0)
OLD = event.OnGreater("too much", NUMBER, 1.0, "data")


@pytest.mark.parametrize("made", [E, OLD], ids=["expression", "named"])
@pytest.mark.parametrize(
    ("use", "ours"),
    [
        (lambda e: ~e, r"Event\(~\(condition\)\)"),
        (lambda e: e.trig(), "launcher.on"),
        (lambda e: e.raise_event_trigger(), "launcher.on"),
        (lambda e: e.clear(), "kompass-console rules reset"),
        (lambda e: e.reset(), "kompass-console rules reset"),
        (lambda e: e.trigger, "kompass-console rules explain"),
        (lambda e: e.under_processing, "kompass-console rules explain"),
        (lambda e: e.register_method("x", print), r"launcher\.on\(event, Action"),
        (lambda e: e.register_actions([]), r"launcher\.on\(event, "),
        (lambda e: e.clear_actions(), r"launcher\.on\(event, "),
        (lambda e: e.json, "kompass-console rules export"),
        (lambda e: e.dictionary, "kompass-console rules export"),
        (lambda e: e.to_json(), "kompass-console rules export"),
        (lambda e: e.to_dict(), "kompass-console rules export"),
        (lambda e: e.from_json("{}"), "kompass-console rules"),
        (lambda e: e.from_dict({}), "kompass-console rules"),
        (lambda e: e.get_involved_topics(), "kompass-console rules"),
        (lambda e: e.check_condition({}), "kompass-console rules backtest"),
    ],
)
def test_what_events_of_other_releases_have_names_what_does_it_here(
    made: Event, use: Callable[[Any], Any], ours: str
) -> None:
    with pytest.raises((TypeError, AttributeError), match=ours) as told:
        use(made)
    assert "\n" not in str(told.value)


def test_the_id_of_an_event_is_that_of_its_rule() -> None:
    assert OLD.id == "too-much"
    assert read({OLD: log(msg="x")}).table.rules[0].id == OLD.id
    stated = Event(NUMBER).as_rule("each-number")
    assert stated.id == "each-number"
    with pytest.raises(AttributeError, match=r"as_rule"):
        assert E.id


def test_an_event_has_no_other_names() -> None:
    with pytest.raises(AttributeError, match="no attribute 'keep'"):
        assert E.keep


def test_parsers_of_one_name_are_told_apart() -> None:
    def sends(name: str) -> Action:
        return trigger_service(srv_name=name, srv_type=SetBool)

    made = read({Event(FLAG): [sends("a"), sends("b")]})
    entries = [made.functions[a.name] for a in made.table.rules[0].actions if isinstance(a, Python)]
    assert [e.action.service for e in entries if isinstance(e, Parsed)] == ["a", "b"]  # type: ignore[union-attr]
    assert not isinstance(entries[0], SendGoal)


# -- parsers --------------------------------------------------------------------------------------


def words(*, msg: Any, **_: object) -> str:
    return "words"


def parsed(action: Action, output: str | None, **extra: Any) -> Action:
    action.event_parser(words, output, **extra)
    return action


def say(text: str, loud: bool = False) -> tuple[str, bool]:
    return text, loud


@pytest.mark.parametrize(
    ("make", "sentence"),
    [
        (
            lambda: parsed(trigger_service(srv_name="/light", srv_type=SetBool), "data"),
            r"output_mapping = 'data' .*call_service.*srv_request_msg or request",
        ),
        (lambda: parsed(log(msg="x"), "msg"), r"output_mapping = 'msg' .*log.*takes none"),
        (
            lambda: parsed(Action(DRIVER.move_forward, args=(1.0,)), "max_distanc"),
            r"output_mapping = 'max_distanc' .*move_forward.*max_distance",
        ),
        (lambda: parsed(Action(say), "txt"), r"output_mapping = 'txt' .*say.*text or loud"),
    ],
)
def test_a_parser_for_an_argument_that_there_is_not_is_refused(
    make: Callable[[], Action], sentence: str
) -> None:
    with pytest.raises(ValueError, match=sentence) as told:
        read({Event(TEXT): make()})
    assert "\n" not in str(told.value)


def test_what_a_parser_is_given_besides_is_given_to_the_function_too() -> None:
    made = read({Event(TEXT): parsed(Action(say), "text", loud=True, other=1)})
    (action,) = made.table.rules[0].actions
    assert isinstance(action, Python)
    assert called(made, action, {**action.kwargs, "msg": String()}) == ("words", True)


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (
            lambda: event.OnAny("e", NUMBER, handle_onc=True),  # type: ignore[call-arg]
            r"OnAny\(\) has no argument 'handle_onc'; did you mean 'handle_once'\?",
        ),
        (
            lambda: event.OnEqual("e", NUMBER, 1.0, "data", handle_onc=True),  # type: ignore[call-arg]
            r"OnEqual\(\) has no argument 'handle_onc'; did you mean 'handle_once'\?",
        ),
        (
            lambda: event.OnGreater("e", NUMBER, 1.0, "data", or_equl=True),  # type: ignore[call-arg]
            r"OnGreater\(\) has no argument 'or_equl'; did you mean 'or_equal'\?",
        ),
        (
            lambda: event.OnEqual("e", NUMBER),  # type: ignore[call-arg]
            r"OnEqual\(\): missing a required argument: 'trigger_value'; it takes event_name, ",
        ),
        (
            lambda: Event(NUMBER, on_chang=True),  # type: ignore[call-arg]
            r"Event\(\) has no argument 'on_chang'; did you mean 'on_change'\?",
        ),
        (
            lambda: Action(PLANNER.restart, arg=(1,)),  # type: ignore[call-arg]
            r"Action\(\) has no argument 'arg'; did you mean 'args'\?",
        ),
        (
            lambda: PLANNER.on_fail(Action(PLANNER.restart), max_retris=2),  # type: ignore[call-arg]
            r"on_fail\(\) has no argument 'max_retris'; did you mean 'max_retries'\?",
        ),
        (
            lambda: PLANNER.on_giveup(Action(PLANNER.restart), max_retris=2),  # type: ignore[call-arg]
            r"on_giveup\(\) has no argument 'max_retris'; did you mean 'max_retries'\?",
        ),
        (
            lambda: log(mesg="x"),  # type: ignore[call-arg]
            r"log\(\) has no argument 'mesg'; did you mean 'msg'\?",
        ),
    ],
)
def test_an_argument_that_is_none_is_offered_the_nearest(
    call: Callable[[], object], said: str
) -> None:
    with pytest.raises(TypeError, match=said) as refused:
        call()
    assert "__init__" not in str(refused.value)
    assert "_Valued" not in str(refused.value)
