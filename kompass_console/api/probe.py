"""The probe's websocket: how a condition that is being written would be judged right now."""

from __future__ import annotations

import asyncio
import json

from fastapi import APIRouter, WebSocket
from pydantic import ValidationError

from kompass.invalid import first_invalid
from kompass_console.api.access import console_of
from kompass_console.api.sockets import Pace, admitted, telling, texts
from kompass_console.link.rules.probes import ConditionProbe
from kompass_console.link.rules.topic_watch import TopicWatch
from kompass_console.schema.roles import Role
from kompass_console.schema.rule_models import ProbeReading, ProbeRequest

router = APIRouter()

_PERIOD = 0.2  # s between two readings
_MOST_PROBES = 12  # of one page
_REQUESTS = (10.0, 60)  # a second, and at once: one for each key that is pressed
_LARGEST = 100_000  # characters of one request


class PageProbes:
    """The probes of one page."""

    def __init__(self, topics: TopicWatch) -> None:
        self._topics = topics
        self._probes: dict[str, ConditionProbe] = {}
        self._errors: dict[str, str] = {}
        self.any = asyncio.Event()

    def take(self, text: str) -> None:
        """Begin, replace or end a probe, as a page asks; what is wrong becomes a reading."""
        if len(text) > _LARGEST:
            self._fail("", f"The condition is longer than {_LARGEST} characters; make it shorter.")
            return
        try:
            request = ProbeRequest.model_validate_json(text)
        except ValidationError as error:
            invalid = first_invalid(error)
            self._fail(_id_of(text), f"{invalid.where or 'The message'}: {invalid.text}.")
            return
        self._end(request.id)
        if request.condition is None:
            return
        if len(self._probes) >= _MOST_PROBES:
            self._fail(request.id, f"At most {_MOST_PROBES} conditions can be looked at; end one.")
            return
        self._probes[request.id] = ConditionProbe(
            request.id, request.condition, request.clear, self._topics
        )
        self.any.set()

    def readings(self) -> list[ProbeReading]:
        """One for each probe, and once for each request that could not be taken."""
        errors, self._errors = self._errors, {}
        if not self._probes:
            self.any.clear()
        failed = [ProbeReading.failed(probe_id, error) for probe_id, error in errors.items()]
        return failed + [probe.reading() for probe in self._probes.values()]

    def close(self) -> None:
        for probe_id in list(self._probes):
            self._end(probe_id)

    def _end(self, probe_id: str) -> None:
        probe = self._probes.pop(probe_id, None)
        if probe is not None:
            probe.close()

    def _fail(self, probe_id: str, error: str) -> None:
        self._end(probe_id)
        if len(self._errors) < _MOST_PROBES:
            self._errors[probe_id] = error
        self.any.set()


@router.websocket("/api/rules/probe")
async def probe(websocket: WebSocket) -> None:
    """See `ProbeRequest` and `ProbeReading` in the schema. Takes an operator: it makes the console
    listen to whatever topic is named."""
    async with admitted(websocket, Role.OPERATOR) as session:
        if session is None:
            return
        await websocket.accept()
        probes = PageProbes(console_of(websocket).link.topics)
        try:
            async with telling(_tell(websocket, probes)):
                async for text in texts(websocket, Pace(*_REQUESTS)):
                    probes.take(text)
        finally:
            probes.close()


async def _tell(websocket: WebSocket, probes: PageProbes) -> None:
    while True:
        await probes.any.wait()
        for reading in probes.readings():
            await websocket.send_text(reading.model_dump_json())
        await asyncio.sleep(_PERIOD)


def _id_of(text: str) -> str:
    """The id in a request that is wrong elsewhere; empty if there is none."""
    try:
        found = json.loads(text)
    except (ValueError, RecursionError):
        return ""
    probe_id = found.get("id") if isinstance(found, dict) else None
    return probe_id[:100] if isinstance(probe_id, str) else ""
