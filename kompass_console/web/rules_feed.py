"""Tells every page how the rules are doing: five times a second at most, newest wins.

What fires is not a value that a newer one replaces: a page that reads slowly gets all steps that
it missed in its next message, as far back as the link keeps them, and is told of the rest.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import logging
from collections.abc import Iterator

from pydantic import TypeAdapter

from kompass.rulebook.schema.status import RuleStatus
from kompass_console.link.rules.watch import RulesWatch
from kompass_console.schema.plain import plain, plain_json
from kompass_console.schema.rule_models import RulesLive

_PERIOD = 0.2  # s between two messages
_SILENCE = 1.0  # s after which a page is told even so: ages grow, and silence is news
_STEPS = 100  # in one message

_STATUSES = TypeAdapter(list[RuleStatus])
_logger = logging.getLogger(__name__)


class RulesListener:
    """One page: what it has been told of, and whether there is something new."""

    def __init__(self, feed: RulesFeed) -> None:
        self._feed = feed
        self._told = feed.count
        self.news = asyncio.Event()
        self.news.set()

    async def get(self) -> str:
        """The next message; waits until there is something new to say."""
        with contextlib.suppress(TimeoutError):
            await asyncio.wait_for(self.news.wait(), _SILENCE)
        self.news.clear()
        text, self._told = self._feed.message(self._told)
        return text


class RulesFeed:
    """Wakes the pages when the monitor has spoken, and writes their messages."""

    def __init__(self) -> None:
        self._listeners: set[RulesListener] = set()
        self._loop: asyncio.AbstractEventLoop | None = None
        self._spoken = asyncio.Event()
        self._rules: RulesWatch | None = None
        self._robot = ""
        self._seen = ("", "[]")

    @property
    def count(self) -> int:
        return 0 if self._rules is None else self._rules.count

    def changed(self) -> None:
        """The monitor has spoken. Any thread."""
        loop = self._loop
        if loop is not None and not loop.is_closed():
            with contextlib.suppress(RuntimeError):  # closed between the question and the call
                loop.call_soon_threadsafe(self._spoken.set)

    @contextlib.contextmanager
    def listen(self) -> Iterator[RulesListener]:
        """A listener for as long as the block lasts; it gets a message at once."""
        listener = RulesListener(self)
        self._listeners.add(listener)
        try:
            yield listener
        finally:
            self._listeners.discard(listener)

    async def run(self, rules: RulesWatch, robot: str) -> None:
        """Wake the pages, until cancelled."""
        self._rules, self._robot = rules, robot
        self._loop = asyncio.get_running_loop()
        while True:
            await self._spoken.wait()
            self._spoken.clear()
            for listener in self._listeners:
                listener.news.set()
            await asyncio.sleep(_PERIOD)

    def message(self, told: int) -> tuple[str, int]:
        """What to tell a page that knows of the first `told` steps, and how many it knows then."""
        assert self._rules is not None  # the server runs the feed before it takes requests
        count = self._rules.count
        steps = self._rules.steps_since(told)[-_STEPS:]
        info = self._rules.info()
        live = RulesLive(
            available=info.available,
            revision=info.revision,
            confirmed=info.confirmed,
            probation_left=info.probation_left,
            notice=info.notice,
            robot=self._robot,
            statuses=[],
            firings=steps,
            missed=max(0, count - told - len(steps)),
            alarms=list(self._rules.alarms()),
            age=info.age,
        )
        head = live.model_dump_json(exclude={"statuses"})
        return f'{head[:-1]},"statuses":{self._statuses()}}}', count

    def _statuses(self) -> str:
        """Looked at once, however many pages get it."""
        assert self._rules is not None
        said = self._rules.statuses()
        if said is not self._seen[0]:
            self._seen = said, _plain_statuses(said)
        return self._seen[1]


def _plain_statuses(said: str) -> str:
    """What the monitor said, as it is to be shown."""
    try:
        statuses = _STATUSES.validate_json(said)
    except ValueError as error:
        _logger.error("what the monitor says of the rules cannot be read: %s", plain(error))
        return "[]"
    if said.isprintable() and "\\u" not in said:
        return said  # as good as always
    return json.dumps([plain_json(status) for status in json.loads(_STATUSES.dump_json(statuses))])
