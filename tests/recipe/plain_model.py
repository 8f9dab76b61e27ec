"""What a recipe means, written as plainly as possible, beside and without the rule engine.

An event is a tree over the newest messages. Every sentence here is one of the documentation's: what
is too old or never came is unknown, unknown fires nothing, an edge is armed again by false only,
what is due by time alone comes before the next message. Actions take no time.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

Verdict = bool | None
NEVER = -math.inf


@dataclass
class Leaf:
    """A comparison of the value of a topic, or of one item of it."""

    topic: str
    judge: Callable[[Any], Verdict]


@dataclass
class Message:
    """A message of the topic arrives."""

    topic: str


@dataclass
class Moved:
    """The value of the topic differs from the one before."""

    topic: str


@dataclass
class Both:
    parts: list[Tree]


@dataclass
class Either:
    parts: list[Tree]


@dataclass
class Opposite:
    part: Tree


Tree = Leaf | Message | Moved | Both | Either | Opposite


@dataclass
class Meaning:
    """An event and its actions.

    Attributes
    ----------
    actions
        Each gives what it does for the world at that moment and the message; None when it fails.
    """

    tree: Tree
    actions: list[Callable[[World, Any], Any]]
    trigger: str = "level"
    first_true_is_edge: bool = True
    once: bool = False
    cooldown: float = 0.0
    hold: float = 0.0
    armed: bool = field(init=False)
    since: float | None = None
    held: bool = False
    cool_until: float = NEVER
    spent: bool = False

    def __post_init__(self) -> None:
        self.armed = self.trigger != "edge" or self.first_true_is_edge


class World:
    """Topics, their newest values, and what the events make of them.

    Parameters
    ----------
    timeouts
        Seconds for which the messages of each topic count; None for ever.
    """

    def __init__(self, timeouts: dict[str, float | None], events: list[Meaning]) -> None:
        self.timeouts, self.events = timeouts, events
        self.newest: dict[str, tuple[float, Any]] = {}
        self.before: dict[str, Any] = {}  # the last usable value, for what moves
        self.done: list[tuple[float, int, list[Any]]] = []

    def hear(self, topic: str, value: Any, now: float) -> None:
        """A message arrives."""
        self._pass(now)
        usable = not (isinstance(value, float) and math.isnan(value))
        moved = usable and topic in self.before and self.before[topic] != value
        self.newest[topic] = (now, value)
        for number, event in enumerate(self.events):
            if topic not in topics_of(event.tree):
                continue
            verdict = self._verdict(event.tree, now, topic, moved)
            self._take(event, verdict, now)
            occasion = moved or event.trigger != "change"
            if verdict is True and (event.held or not event.hold) and occasion:
                self._attempt(number, now, value)
            # Between messages nothing arrives and nothing moves.
            self._take(event, self._verdict(event.tree, now, "", False), now)
        if usable:
            self.before[topic] = value

    def _pass(self, now: float) -> None:
        """Let time pass: values grow old, and holds end."""
        due = sorted(
            (event.since + event.hold, number)
            for number, event in enumerate(self.events)
            if event.hold and event.since is not None and event.since + event.hold <= now
            if not event.held
        )
        for at, number in due:
            event = self.events[number]
            if self._verdict(event.tree, at, "", False) is True:
                event.held = True
                self._attempt(number, at, None)
        for event in self.events:
            self._take(event, self._verdict(event.tree, now, "", False), now)

    def _take(self, event: Meaning, verdict: Verdict, now: float) -> None:
        if verdict is True:
            event.since = now if event.since is None else event.since
            return
        event.since, event.held = None, False
        if verdict is False:
            event.armed = True

    def _attempt(self, number: int, now: float, message: Any) -> None:
        event = self.events[number]
        if event.once and event.spent:
            return
        if event.trigger == "edge":
            if not event.armed:
                return
            event.armed = False
        if now < event.cool_until:
            return
        event.spent, event.cool_until = True, now + event.cooldown
        made: list[Any] = []
        for action in event.actions:
            made.append(action(self, message))
            if made[-1] is None:
                break  # what failed ends the list
        self.done.append((now, number, made))

    def _verdict(self, tree: Tree, now: float, arriving: str, moved: bool) -> Verdict:
        if isinstance(tree, Opposite):
            inner = self._verdict(tree.part, now, arriving, moved)
            return None if inner is None else not inner
        if isinstance(tree, Both | Either):
            parts = [self._verdict(part, now, arriving, moved) for part in tree.parts]
            wanted = isinstance(tree, Either)
            if wanted in parts:
                return wanted
            return None if None in parts else not wanted
        known = self.newest.get(tree.topic)
        timeout = self.timeouts[tree.topic]
        if known is None or (timeout is not None and now > known[0] + timeout):
            return None
        if isinstance(tree, Message):
            return tree.topic == arriving
        if isinstance(tree, Moved):
            if tree.topic not in self.before and not arriving:
                return None
            return tree.topic == arriving and moved
        return tree.judge(known[1])


def topics_of(tree: Tree) -> set[str]:
    if isinstance(tree, Opposite):
        return topics_of(tree.part)
    if isinstance(tree, Both | Either):
        return set().union(*map(topics_of, tree.parts))
    return {tree.topic}
