"""Random recipes over the names that recipes import, each with what it means."""

from __future__ import annotations

import asyncio
import functools
import math
import random
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from rclpy.qos import DurabilityPolicy
from std_msgs.msg import Bool, Float32MultiArray, Float64, Int32, String
from std_srvs.srv import SetBool

from kompass import event
from kompass.actions import (
    Action,
    LogInfo,
    publish_message,
    send_srv_request,
    trigger_service,
    update_parameter,
)
from kompass.components import DriveManager, Planner
from kompass.rclpy_ext.topic import Topic
from kompass.ros import Event, Launcher, QoSConfig
from tests.recipe.plain_model import (
    Both,
    Either,
    Leaf,
    Meaning,
    Message,
    Moved,
    Opposite,
    Tree,
    Verdict,
    World,
    topics_of,
)

PLANNER, DRIVER = Planner(), DriveManager()
KINDS: dict[str, Any] = {
    "number": Float64,
    "flag": Bool,
    "text": String,
    "count": Int32,
    "series": Float32MultiArray,
}
NUMBERS: tuple[Any, ...] = (-1.0, 0, 0.5, 1, 2.5)
COUNTS = (-1, 0, 1, 2)
WORDS = ("", "a", "ab", "b", "$msg")
FAILED = None
Do = Callable[[World, Any], Any]


@dataclass
class Recipe:
    """A recipe, what it means, and what its functions have noted.

    Attributes
    ----------
    launcher
        As the recipe leaves it.
    asked
        Scripts of the polled functions by the number of their event: what each answers.
    """

    launcher: Launcher
    world: World
    noted: list[Any]
    asked: dict[int, Callable[[Any], None]] = field(default_factory=dict)


@dataclass(frozen=True)
class Rules:
    """Events with their actions, as they are handed to a launcher, and what they mean.

    Attributes
    ----------
    first
        Given with the components.
    later
        Added to it one by one.
    """

    first: dict[Any, Any]
    later: list[tuple[Any, Any]]
    meanings: list[Meaning]
    asked: dict[int, Callable[[Any], None]]


def value_of(topic: str, rng: random.Random) -> Any:
    if topic == "number":
        return rng.choice((*map(float, NUMBERS), math.nan))
    if topic == "series":
        return [float(rng.choice((0.0, 0.5, 1.0))) for _ in range(rng.randint(0, 3))]
    return {
        "flag": rng.random() < 0.5,
        "text": rng.choice(WORDS),
        "count": rng.choice(COUNTS),
    }[topic]


class Writer:
    """Writes one recipe.

    Parameters
    ----------
    rng
        Decides everything.
    timeless
        Leave out what depends on when things come: holds, pauses, values that grow old, functions
        that are asked; and actions of components.
    """

    def __init__(self, rng: random.Random, *, timeless: bool = False) -> None:
        self.rng, self.timeless = rng, timeless
        self.noted: list[Any] = []
        self.topics: dict[str, Topic] = {}
        self.timeouts: dict[str, float | None] = {}
        self.labels = 0
        for name, kind in KINDS.items():
            timeout = None if timeless else rng.choice((None, 0.5, 1.0, 4.0))
            more: dict[str, Any] = {"data_timeout": timeout}
            if timeout is None:
                latched = DurabilityPolicy.TRANSIENT_LOCAL
                more = {"qos_profile": QoSConfig(durability=latched)}
            elif timeout == 1.0:
                more = {}  # what it is unless stated
            spelt = rng.choice((kind, kind.__name__, f"std_msgs/msg/{kind.__name__}"))
            slash = rng.choice(("", "/"))
            self.topics[name] = Topic(name=f"{slash}{name}", msg_type=spelt, **more)
            self.timeouts[name] = timeout

    def recipe(self) -> Recipe:
        """A recipe of its own, of components that never run."""
        launcher, rng = Launcher(), self.rng
        written = self.rules()
        launcher.kompass([PLANNER], events_actions=written.first)
        launcher.add_pkg([DRIVER], events_actions=None)
        for made, action in written.later:
            launcher.on(made, rng.choice((action, [action])))
        world = World(self.timeouts, written.meanings)
        return Recipe(launcher, world, self.noted, written.asked)

    def rules(self) -> Rules:
        """Events and their actions, for any launcher."""
        rng = self.rng
        meanings: list[Meaning] = []
        asked: dict[int, Callable[[Any], None]] = {}
        first: dict[Any, Any] = {}
        later: list[tuple[Any, Any]] = []
        for number in range(rng.randint(1, 4)):
            choice = rng.random()
            if choice < 0.45:
                made, meaning = self._expression()
            elif choice < 0.75 or self.timeless:
                made, meaning = self._named(number)
            else:
                made, meaning, answer = self._polled(number)
                self.timeouts[f"callable {number}"] = None
                asked[number] = answer
            actions = [self._action(meaning) for _ in range(rng.randint(1, 3))]
            meaning.actions = [do for _, do in actions]
            given = [action for action, _ in actions]
            cut = rng.randint(1, len(given))
            first[made] = given[0] if cut == 1 and rng.random() < 0.5 else given[:cut]
            later += [(made, action) for action in given[cut:]]
            meanings.append(meaning)
        return Rules(first, later, meanings, asked)

    # -- events -------------------------------------------------------------------------------

    def _options(self, meaning: Meaning) -> dict[str, Any]:
        rng = self.rng
        meaning.once = rng.random() < 0.2
        if not self.timeless and rng.random() < 0.3:
            meaning.cooldown = rng.choice((0.25, 1.0))
        return {"handle_once": meaning.once, "keep_event_delay": meaning.cooldown}

    def _expression(self) -> tuple[Event, Meaning]:
        rng = self.rng
        written, tree, lasts = self._tree(rng.randint(0, 2))
        meaning = Meaning(tree, [])
        if rng.random() < 0.5:
            meaning.trigger = "edge"
        made = Event(written, on_change=meaning.trigger == "edge", **self._options(meaning))
        if lasts and not self.timeless and rng.random() < 0.3:
            meaning.hold = rng.choice((0.25, 0.75))
            made = made.as_rule(hold=meaning.hold)
        return made, meaning

    def _tree(self, depth: int, *, negated: bool = False) -> tuple[Any, Tree, bool]:
        rng = self.rng
        kind = rng.choice(("leaf", "and", "or", "not")) if depth else "leaf"
        if kind == "leaf":
            if not negated and rng.random() < 0.15:
                name = rng.choice([*KINDS])
                return self.topics[name], Message(name), False
            written, leaf = self._comparison()
            return written, leaf, True
        if kind == "not":
            written, tree, _ = self._tree(depth - 1, negated=True)
            return ~written, Opposite(tree), True
        one, first, one_lasts = self._tree(depth - 1, negated=negated)
        other, second, other_lasts = self._tree(depth - 1, negated=negated)
        lasts = one_lasts and other_lasts
        if kind == "and":
            return one & other, Both([first, second]), lasts
        return one | other, Either([first, second]), one_lasts and other_lasts

    def _comparison(self) -> tuple[Any, Leaf]:
        name = self.rng.choice([*KINDS])
        written, judge = getattr(self, f"_{name}")(self.topics[name].msg.data)
        return written, Leaf(name, judge)

    def _number(self, field: Any, options: tuple[Any, ...] = NUMBERS) -> tuple[Any, Any]:
        rng = self.rng
        bound, other = rng.choice(options), rng.choice(options)
        low, high = min(bound, other), max(bound, other)

        def known(test: Callable[[Any], bool]) -> Callable[[Any], Verdict]:
            return lambda value: (
                None if isinstance(value, float) and math.isnan(value) else test(value)
            )

        return rng.choice(
            (
                (field == bound, known(lambda v: v == bound)),
                (field != bound, known(lambda v: v != bound)),
                (field < bound, known(lambda v: v < bound)),
                (field <= bound, known(lambda v: v <= bound)),
                (field > bound, known(lambda v: v > bound)),
                (field >= bound, known(lambda v: v >= bound)),
                (field.between(low, high), known(lambda v: low <= v <= high)),
                (field.is_in([bound, other]), known(lambda v: v in (bound, other))),
                (field.not_in((bound, other)), known(lambda v: v not in (bound, other))),
            )
        )

    def _count(self, field: Any) -> tuple[Any, Any]:
        return self._number(field, COUNTS)

    def _flag(self, field: Any) -> tuple[Any, Any]:
        return self.rng.choice(
            (
                (field == True, lambda v: v),  # noqa: E712
                (field == 1, lambda v: v),
                (field != 1, lambda v: not v),
                (field == 0, lambda v: not v),
                (field.is_true(), lambda v: v),
                (field.is_false(), lambda v: not v),
                (~field, lambda v: not v),
                (field.is_in([0, 1]), lambda v: True),
            )
        )

    def _text(self, field: Any) -> tuple[Any, Any]:
        rng = self.rng
        word, other = rng.choice(WORDS), rng.choice(WORDS)
        return rng.choice(
            (
                (field == word, lambda v: v == word),
                (field != word, lambda v: v != word),
                (field < word, lambda v: v < word),
                (field.is_in([word, other]), lambda v: v in (word, other)),
                (field.is_in("cab"), lambda v: v in "cab"),
                (field.not_in([word, other]), lambda v: v not in (word, other)),
                (field.contains(word), lambda v: word in v),
                (field.not_contains(word), lambda v: word not in v),
                (field.contains_any([word, other]), lambda v: word in v or other in v),
                (field.contains_all([word, other]), lambda v: word in v and other in v),
                (field.not_contains_any([word, other]), lambda v: not (word in v or other in v)),
            )
        )

    def _series(self, field: Any) -> tuple[Any, Any]:
        rng = self.rng
        one, other = rng.choice((0, 0.5)), rng.choice((0.5, 1.0))
        return rng.choice(
            (
                (field.contains(one), lambda v: one in v),
                (field.not_contains(one), lambda v: one not in v),
                (field.contains_any((one, other)), lambda v: one in v or other in v),
                (field.contains_all([one, other]), lambda v: one in v and other in v),
                (field.not_contains_all([one, other]), lambda v: not (one in v and other in v)),
                (field == [one, other], lambda v: v == [one, other]),
                (field[0] > one, lambda v: v[0] > one if v else None),
                (field[1] == other, lambda v: v[1] == other if len(v) > 1 else None),
            )
        )

    def _named(self, number: int) -> tuple[Event, Meaning]:
        rng = self.rng
        name = rng.choice(("number", "count", "text", "series"))
        topic, label = self.topics[name], f"event {number}"
        options = {"number": NUMBERS, "count": COUNTS, "text": WORDS, "series": (0.0, 0.5)}[name]
        value, other = rng.choice(options), rng.choice(options)
        path = rng.choice(("data", ["data"], ("data",)))
        of_numbers, of_lists = name in ("number", "count"), name in ("text", "series")

        def known(test: Callable[[Any], bool]) -> Leaf:
            return Leaf(name, lambda v: None if isinstance(v, float) and math.isnan(v) else test(v))

        plain: list[Any] = [
            (event.OnAny, (), Message(name), "level", True),
            (event.OnChange, (path,), Moved(name), "change", True),
        ]
        if name != "series":
            is_it, differs = known(lambda v: v == value), known(lambda v: v != value)
            plain += [
                (event.OnEqual, (value, path), is_it, "level", True),
                (event.OnDifferent, (value, path), differs, "level", True),
                (event.OnChangeEqual, (value, path), is_it, "change", True),
            ]
        if of_numbers:
            plain += [
                (event.OnGreater, (value, path), known(lambda v: v > value), "level", True),
                (event.OnGreater, (value, path, True), known(lambda v: v >= value), "level", True),
                (event.OnLess, (value, path), known(lambda v: v < value), "level", True),
            ]
        if of_lists:
            both = [value, other]
            every = known(lambda v: value in v and other in v)
            some = known(lambda v: value in v or other in v)
            none = known(lambda v: not (value in v or other in v))
            plain += [
                (event.OnContainsAll, (both, path), every, "level", True),
                (event.OnContainsAny, (both, path), some, "level", True),
                (event.OnChangeContainsAll, (both, path), every, "change", True),
                (event.OnChangeContainsAny, (both, path), some, "edge", False),
                (event.OnChangeNotContain, (both, path), none, "edge", False),
            ]
        kind, args, tree, trigger, first = rng.choice(plain)
        meaning = Meaning(tree, [], trigger, first)
        return kind(label, topic, *args, **self._options(meaning)), meaning

    def _polled(self, number: int) -> tuple[Event, Meaning, Callable[[Any], None]]:
        """All of them call themselves the same."""
        rng, script = self.rng, {"answer": False}

        def check() -> bool:
            return script["answer"]

        async def check_async() -> bool:
            await asyncio.sleep(0)
            return script["answer"]

        check_async.__name__ = "check"

        def check_of(script: dict[str, bool]) -> bool:
            return script["answer"]

        check_of.__name__ = "check"

        class Sensor:
            def check(self) -> bool:
                return script["answer"]

        asked = rng.choice(
            (check, check_async, lambda: script["answer"], Sensor().check, Action(check))
        )
        tree = Leaf(f"callable {number}", lambda value: value)
        meaning = Meaning(tree, [], rng.choice(("level", "edge")))
        made = Event(
            asked,
            on_change=meaning.trigger == "edge",
            check_rate=rng.choice((None, 5, 20.0)),
            **self._options(meaning),
        )
        return made, meaning, lambda answer: script.update(answer=answer)

    # -- actions ------------------------------------------------------------------------------

    def _action(self, meaning: Meaning) -> tuple[Action, Do]:
        kinds = [self._log, self._function, self._function, self._function, self._data]
        source = _only_topic(meaning)
        if source is not None and not meaning.hold:
            kinds += [lambda: self._parser(source)] * 2
        return self.rng.choice(kinds)()

    def _label(self) -> str:
        self.labels += 1
        return f"note {self.labels}"

    def _log(self) -> tuple[Action, Do]:
        text = f"{self._label()} {self.rng.choice(WORDS)}"
        return LogInfo(msg=text), lambda world, message: ("log", text)

    def _argument(self) -> tuple[Any, Callable[[World], Any]]:
        """A value to hand over, and what arrives; KeyError for what was never heard."""
        rng = self.rng
        if rng.random() < 0.5:
            value = rng.choice((1, 2.5, True, "a", "$msg", "$5", [1, "$x"], {"k": ["$$"]}, None))
            return value, lambda world: value
        name = rng.choice([*KINDS])
        field = self.topics[name].msg.data

        def newest(world: World) -> Any:
            return world.newest[name][1]

        return rng.choice(
            (
                (field, newest),
                ([field, 1], lambda world: [newest(world), 1]),
                ({"in": (field,)}, lambda world: {"in": [newest(world)]}),
            )
        )

    def _function(self) -> tuple[Action, Do]:
        """A function that notes what it was given; they all have one name, or none."""
        rng, label, noted = self.rng, self._label(), self.noted

        def note(value: Any, more: Any = "usual") -> str:
            noted.append((label, value, more))
            return label

        async def note_later(value: Any, more: Any = "usual") -> str:
            await asyncio.sleep(0)
            return note(value, more)

        note_later.__name__ = "note"

        def positional(value: Any, more: Any = "usual", /) -> str:
            return note(value, more)

        positional.__name__ = "note"

        def many(*values: Any) -> str:
            return note(*values)

        many.__name__ = "note"

        def named(**values: Any) -> str:
            return note(values["value"], values.get("more", "usual"))

        named.__name__ = "note"

        class Notes:
            def note(self, value: Any, more: Any = "usual") -> str:
                return note(value, more)

        (value, arrives), (more, more_arrives) = self._argument(), self._argument()
        with_more = rng.random() < 0.5
        function = rng.choice(
            (
                note,
                note_later,
                positional,
                many,
                named,
                Notes().note,
                lambda value, more="usual": note(value, more),
                functools.partial(note),
            )
        )
        by_name = function is named or (function not in (positional, many) and rng.random() < 0.5)
        if by_name:
            kwargs = {"value": value, **({"more": more} if with_more else {})}
            action = Action(function, kwargs=kwargs)
        else:
            action = Action(function, args=(value, more) if with_more else (value,))

        def does(world: World, message: Any) -> Any:
            try:
                got = arrives(world)
                rest = more_arrives(world) if with_more else "usual"
            except KeyError:
                return FAILED
            return ("note", (label, got, rest))

        return action, does

    def _data(self) -> tuple[Action, Do]:
        rng = self.rng
        flag, number = self.topics["flag"].msg.data, self.topics["number"].msg.data
        word, rate = rng.choice(WORDS), rng.choice((1, 2.5))

        def heard(name: str, make: Callable[[Any], Any]) -> Do:
            return lambda world, message: (
                make(world.newest[name][1]) if name in world.newest else FAILED
            )

        said = Topic(name="said", msg_type="String")
        request: dict[str, Any] = {"srv_name": "/light", "srv_type": SetBool}

        def asked(value: Any) -> Any:
            return ("call_service", "light", {"data": value})

        def set_to(value: Any) -> Any:
            return ("update_parameters", "planner", {"loop_rate": value})

        setting: dict[str, Any] = {"component": PLANNER, "param_name": "loop_rate"}
        choices: list[tuple[Action, Do]] = [
            (
                publish_message(topic=said, msg=String(data=word)),
                lambda world, message: ("publish", "said", {"data": word}),
            ),
            (
                publish_message(topic=said, msg={"data": self.topics["text"].msg.data}),
                heard("text", lambda value: ("publish", "said", {"data": value})),
            ),
            (
                send_srv_request(**request, srv_request_msg=SetBool.Request(data=True)),
                lambda world, message: asked(True),
            ),
            (
                send_srv_request(**request, srv_request_msg={"data": flag}),
                heard("flag", asked),
            ),
            (
                update_parameter(**setting, new_value=rate),
                lambda world, message: set_to(rate),
            ),
            (update_parameter(**setting, new_value=number), heard("number", set_to)),
            (
                Action(DRIVER.restart),
                lambda world, message: ("lifecycle", "drive_manager", "restart"),
            ),
            (
                Action(DRIVER.move_forward, args=(0.5,)),
                lambda world, message: ("method", "drive_manager", {"max_distance": 0.5}),
            ),
            (
                Action(DRIVER.move_forward, kwargs={"max_distance": number}),
                heard("number", lambda v: ("method", "drive_manager", {"max_distance": v})),
            ),
        ]
        return rng.choice(choices[:4] if self.timeless else choices)

    def _parser(self, source: str) -> tuple[Action, Do]:
        """A function, or a request, whose argument is made from the message of ``source``."""
        rng, label, noted = self.rng, self._label(), self.noted

        def parse(*, msg: Any, **extra: Any) -> Any:
            return [plain(msg.data), extra.get("unit", "")]

        async def parse_later(*, msg: Any, **extra: Any) -> Any:
            await asyncio.sleep(0)
            return parse(msg=msg, **extra)

        parse_later.__name__ = "parse"

        def note(value: Any, unit: str = "none") -> str:
            noted.append((label, value, unit))
            return label

        if source == "flag" and rng.random() < 0.5:
            return trigger_service(srv_name="/light", srv_type=SetBool), (
                lambda world, message: ("call_service", "light", {"data": message})
            )
        action = Action(note)
        with_unit = rng.random() < 0.5
        extra = {"unit": "m"} if with_unit else {}
        if rng.random() < 0.5:
            action.event_parser(rng.choice((parse, parse_later)), "value", **extra)
        else:
            action.event_parser(lambda **k: {"value": parse(**k)}, **extra)
        return action, lambda world, message: (
            "note",
            (label, [message, "m" if with_unit else ""], "m" if with_unit else "none"),
        )


def plain(value: Any) -> Any:
    tolist = getattr(value, "tolist", None)
    return value if tolist is None else tolist()


def _only_topic(meaning: Meaning) -> str | None:
    """The topic whose message fires it, when there is one only."""
    topics = topics_of(meaning.tree)
    (only,) = topics if len(topics) == 1 else (None,)
    return only if only in KINDS else None


def _generator() -> Any:
    yield True


def _needs(what: str) -> bool:
    return bool(what)


# What nobody can carry out, each added to a recipe that is sound.
MISTAKES: dict[str, Callable[[Writer, Launcher], Any]] = {
    "no such field": lambda w, _: w.topics["number"].msg.dta > 1,
    "text for a number": lambda w, _: w.topics["number"].msg.data == "high",
    "number for a text": lambda w, _: w.topics["text"].msg.data.contains(1),
    "no truth value": lambda w, _: w.topics["flag"].msg.data == 2,
    "bounds the wrong way round": lambda w, _: w.topics["count"].msg.data.between(2, 1),
    "not finite": lambda w, _: w.topics["number"].msg.data < math.inf,
    "no number": lambda w, _: w.topics["number"].msg.data == math.nan,
    "order of truth values": lambda w, _: w.topics["flag"].msg.data < True,
    "nothing to choose from": lambda w, _: w.topics["text"].msg.data.is_in([]),
    "a value alone": lambda w, _: Event(w.topics["flag"].msg.data),
    "and": lambda w, _: (w.topics["count"].msg.data > 1) and (w.topics["count"].msg.data < 2),
    "no opposite of a message": lambda w, _: Event(~(w.topics["flag"] | w.topics["count"])),
    "a hold on a message": lambda w, _: Event(w.topics["flag"]).as_rule(hold=1.0),
    "an unknown field of a rule": lambda w, _: Event(w.topics["flag"]).as_rule(holds=1.0),
    "an id that is none": lambda w, launcher: launcher.on(
        Event(w.topics["flag"]).as_rule("No Id!"), LogInfo(msg="x")
    ),
    "no rate": lambda w, _: Event(lambda: True, check_rate=0),
    "a negative delay": lambda w, _: Event(w.topics["flag"], keep_event_delay=-1.0),
    "a delay for ever": lambda w, _: Event(w.topics["flag"], keep_event_delay=math.inf),
    "a component's method as condition": lambda w, _: Event(DRIVER.restart),
    "a generator as condition": lambda w, _: Event(_generator),
    "a generator as action": lambda w, _: Action(_generator),
    "a condition that needs something": lambda w, _: Event(_needs),
    "a condition with a value of a topic": lambda w, _: Event(
        Action(_needs, args=(w.topics["text"].msg.data,))
    ),
    "an action as condition": lambda w, _: Event(LogInfo(msg="x")),
    "too many arguments": lambda w, _: Action(_needs, args=(1, 2)),
    "a missing argument": lambda w, launcher: launcher.on(Event(w.topics["flag"]), Action(_needs)),
    "no action": lambda w, launcher: launcher.on(Event(w.topics["flag"]), []),
    "a function that is no Action": lambda w, launcher: launcher.on(
        Event(w.topics["flag"]), _needs
    ),
    "a condition that is no event": lambda w, launcher: launcher.on(
        w.topics["flag"], LogInfo(msg="x")
    ),
    "an argument that is no data": lambda w, _: Action(_needs, args=(object(),)),
    "an argument that is not finite": lambda w, _: Action(_needs, args=([math.nan],)),
    "a method that is no action": lambda w, _: Action(DRIVER.publish_status),
    "an argument of the wrong type": lambda w, _: Action(DRIVER.move_forward, args=("far",)),
    "no such parameter": lambda w, _: update_parameter(
        component=PLANNER, param_name="loop_rat", new_value=1.0
    ),
    "a parameter out of range": lambda w, _: update_parameter(
        component=PLANNER, param_name="loop_rate", new_value=-1.0
    ),
    "a field that the message has not": lambda w, launcher: launcher.on(
        Event(w.topics["flag"]),
        publish_message(topic=w.topics["text"], msg={"dta": "x"}),
    ),
    "a request for another service": lambda w, launcher: launcher.on(
        Event(w.topics["flag"]),
        send_srv_request(srv_name="/light", srv_type=SetBool, srv_request_msg={"on": True}),
    ),
    "a parser for nothing": lambda w, launcher: launcher.on(
        Event(w.topics["flag"]), _parsed_for(Action(_needs), "whatever")
    ),
    "a component of another launcher": lambda w, launcher: launcher.on(
        Event(w.topics["flag"]), Action(Planner("stranger").restart)
    ),
    "two events of one name": lambda w, launcher: launcher.kompass(
        [],
        events_actions={
            event.OnAny("same", w.topics["flag"]): LogInfo(msg="x"),
            event.OnAny("same", w.topics["text"]): LogInfo(msg="y"),
        },
    ),
    "a name of another release": lambda w, _: Event(w.topics["flag"]).reset(),
    "the opposite of an event": lambda w, _: ~Event(w.topics["flag"]),
}


def _parsed_for(action: Action, output: str) -> Action:
    action.event_parser(lambda **_: "x", output)
    return action
