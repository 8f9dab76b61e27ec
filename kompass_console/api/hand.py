"""Driving by hand: the websocket of a page that has, or wants, the wheel."""

from __future__ import annotations

import asyncio
import time

from fastapi import APIRouter, WebSocket
from pydantic import ValidationError

from kompass.algorithms.safety.delay import Delay
from kompass.rclpy_ext.reply import NoAnswer
from kompass_console.api.access import console_of
from kompass_console.api.sockets import Pace, admitted, telling, texts
from kompass_console.link.wheel import Hold, WheelRefused
from kompass_console.schema.hand_models import HandAnswer, HandRequest
from kompass_console.schema.roles import Role
from kompass_console.web.auth import LoginSession
from kompass_console.web.console import Console
from kompass_console.web.errors import ConsoleError

router = APIRouter()

_MESSAGES = (60.0, 400)  # a second, and at once: a page says twenty; more after a console was held
_LONGEST = 500  # characters of one message
SILENT = 0.25  # s without a page's word after which its hand counts as away
_LOOK = 0.05  # s between two looks at that
_GIVEN_UP = 5.0  # s of silence; the drive manager waits no longer, either
_SETTLES = 2.0  # s in which the drive manager has said who drives

_GONE = "the drive manager has gone"
_LOST = "The wheel was lost: {why}. Take it again."


class HandPage:
    """One page, which may have the wheel. Lives on the web server's loop."""

    def __init__(self, console: Console, session: LoginSession) -> None:
        self._console, self._session = console, session
        self._hold: Hold | None = None
        self._taken = self._heard = 0.0  # monotonic s
        self._confirmed = False  # the drive manager has said that the wheel is this page's
        self._moves = False
        self._delay = Delay()
        self._answers: asyncio.Queue[HandAnswer] = asyncio.Queue()
        self._leaving: asyncio.Task[None] | None = None
        self._tell()

    @property
    def session_id(self) -> str:
        """Of the log-in that it is a page of."""
        return self._session.id

    def lost_control(self, by: str) -> None:
        """Somebody else has control of the robot now: stand, and give the wheel up."""
        self._leaving = asyncio.ensure_future(self._leave(by))

    def asked(self, by: str) -> None:
        """Somebody else asks for the wheel."""
        self._tell(asked_by=by)

    async def take_in(self, text: str) -> None:
        """Do what the page says."""
        if len(text) > _LONGEST:
            return
        try:
            request = HandRequest.model_validate_json(text)
        except ValidationError:
            self._tell("This page and this console do not understand each other: reload the page.")
            return
        if request.type == "drive":
            self._drive(request)
        elif request.type == "ask":
            self._ask()
        elif request.type == "give":
            hold = self._let_go("given up")
            # Before the drive manager answers: who has asked may see a free wheel by then.
            self._console.control.gave_wheel(self._session)
            await self._free(hold)
        else:
            await self._take(over=request.type == "take over")

    async def tell(self, websocket: WebSocket) -> None:
        """Send the page what there is to say, until cancelled."""
        while True:
            answer = await self._answers.get()
            await websocket.send_text(answer.model_dump_json())

    async def watch(self) -> None:
        """See to it that a page that says nothing drives nothing, until cancelled."""
        while True:
            await asyncio.sleep(_LOOK)
            hold, now = self._hold, time.monotonic()
            if hold is None:
                continue
            silence = now - self._heard
            if self._moves and silence >= SILENT:
                # Beside the drive manager, which does not wait for this.
                self._moves = False
                if not hold.drive(0.0, 0.0, 0.0):
                    self._lose(_GONE)
                    continue
            if silence >= _GIVEN_UP:
                await self._give("the page was silent")
                self._tell(_LOST.format(why=f"nothing was heard of this page for {_GIVEN_UP:g} s"))
            else:
                self._look_whose(hold, now)

    async def close(self) -> None:
        """The page has gone: stand, and give the wheel up."""
        await self._give("the page was closed")

    # -- what the page asks for ---------------------------------------------------------------

    def _drive(self, request: HandRequest) -> None:
        now = time.monotonic()
        delay = self._delay.of(request.t, now)
        if self._hold is None or delay >= SILENT:
            return
        self._heard = now - delay
        twist = (request.vx, request.vy, request.omega)
        self._moves = any(twist)
        if not self._hold.drive(*twist, age=delay):
            self._lose(_GONE)

    async def _take(self, *, over: bool) -> None:
        deed = "take over the wheel" if over else "take the wheel"
        drive = self._console.link.drive.info()
        before = "" if drive is None else drive.driven_by
        if over and not self._session.role.covers(Role.ENGINEER):
            problem = "Only an engineer takes the wheel over; ask whoever drives for it."
            self._console.audit.record(self._session, deed, problem, before=before)
            self._tell(problem)
            return
        if self._hold is not None:
            self._tell()
            return
        try:
            if over:
                self._console.control.take(self._session, "took the wheel over")
            else:
                self._console.control.require(self._session, deed, {"before": before})
        except ConsoleError as error:
            self._tell(f"{error.title} {error.remedy}")
            return
        try:
            hold = await self._console.link.wheel.take(self._session.user, over=over)
        except (NoAnswer, WheelRefused) as error:
            why = error.why if isinstance(error, NoAnswer) else str(error)
            self._console.audit.record(self._session, deed, why, before=before)
            self._tell(f"You do not have the wheel: {why}.")
            return
        try:
            # Somebody may have taken control while the drive manager was asked.
            self._console.control.require(self._session, deed, {"before": before})
        except ConsoleError as error:
            self._tell(f"{error.title} {error.remedy}")
            await self._free(hold)
            return
        self._console.audit.record(self._session, deed, "taken", before=before)
        self._hold, self._confirmed, self._moves = hold, False, False
        self._taken = self._heard = time.monotonic()
        self._delay = Delay()
        self._console.hands.took(self)
        self._tell()

    async def _give(self, why: str, message: str = "") -> None:
        await self._free(self._let_go(why, message))

    def _let_go(self, why: str, message: str = "") -> Hold | None:
        """The page has the wheel no more; what the drive manager is to be told of, if it had."""
        hold = self._drop()
        if hold is not None:
            hold.drive(0.0, 0.0, 0.0)
            self._console.audit.record(self._session, "give up the wheel", why)
            self._tell(message)
        return hold

    async def _free(self, hold: Hold | None) -> None:
        """Have the drive manager give the wheel to whoever comes next."""
        if hold is None:
            return
        try:
            await self._console.link.wheel.give(hold, self._session.user)
        except NoAnswer as error:
            self._tell(f"The drive manager does not answer: {error.why}.")

    def _ask(self) -> None:
        drive = self._console.link.drive.info()
        driver = drive.driven_by if drive is not None and drive.available else ""
        if not driver:
            self._tell("Nobody has the wheel: take it.")
        elif self._console.hands.ask(self._session.user):
            try:
                self._console.control.ask(self._session)
            except ConsoleError as error:
                self._tell(f"{error.title} {error.remedy}")
            else:
                self._tell(f"{driver} has been asked.")
        else:
            self._tell(f"{driver} drives from another console, and cannot be asked from here.")

    # -- whose it is --------------------------------------------------------------------------

    def _look_whose(self, hold: Hold, now: float) -> None:
        """Believe the drive manager on who drives."""
        mine = self._console.link.drive.hand_session == hold.session
        self._confirmed = self._confirmed or mine
        if mine or (not self._confirmed and now - self._taken < _SETTLES):
            return
        drive = self._console.link.drive.info()
        other = "" if drive is None else drive.driven_by
        self._lose(f"{other} took it over" if other else "the drive manager gave it up")

    async def _leave(self, by: str) -> None:
        if by == "":
            await self._give("control was given up")
        else:
            await self._give(f"{by} has control now", f"{by} has control of the robot now.")

    def _lose(self, why: str) -> None:
        self._drop()
        self._console.audit.record(self._session, "lose the wheel", why)
        self._tell(_LOST.format(why=why))

    def _drop(self) -> Hold | None:
        hold, self._hold = self._hold, None
        self._moves = False
        self._console.hands.gave(self)
        return hold

    def _tell(self, message: str = "", *, asked_by: str = "") -> None:
        hold = self._hold
        vx, vy, omega = (0.0, 0.0, 0.0) if hold is None else hold.limits
        self._answers.put_nowait(
            HandAnswer(
                yours=hold is not None,
                max_vx=vx,
                max_vy=vy,
                max_omega=omega,
                message=message,
                asked_by=asked_by,
            )
        )


@router.websocket("/api/hand")
async def hand(websocket: WebSocket) -> None:
    """See `HandRequest` and `HandAnswer` in the schema. Takes an operator."""
    async with admitted(websocket, Role.OPERATOR) as session:
        if session is None:
            return
        await websocket.accept()
        page = HandPage(console_of(websocket), session)
        try:
            async with telling(page.tell(websocket)), telling(page.watch()):
                async for text in texts(websocket, Pace(*_MESSAGES)):
                    await page.take_in(text)
        finally:
            await page.close()
