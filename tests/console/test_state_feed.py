"""Pages get the newest state; a slow one skips, and what matters does not wait."""

from __future__ import annotations

import asyncio
import time

import pytest

from kompass_console.schema.models import (
    LocalisationInfo,
    LogInfo,
    MissionsInfo,
    PlacesInfo,
    RobotInfo,
    RosInfo,
    RulesInfo,
    State,
    TimelineInfo,
    ZonesInfo,
)
from kompass_console.web.state_feed import StateFeed, StateListener


def build(seq: int, viewers: int) -> State:
    return State(
        seq=seq,
        time=time.time(),
        robot=RobotInfo(name="r", radius=None),
        pose=None,
        localisation=LocalisationInfo(),
        streams=[],
        components=[],
        drive=None,
        goal=None,
        simulation=None,
        rules=RulesInfo(),
        places=PlacesInfo(),
        zones=ZonesInfo(),
        timeline=TimelineInfo(),
        log=LogInfo(),
        missions=MissionsInfo(),
        processes=[],
        ros=RosInfo(domain_id=0, middleware="none"),
        viewers=viewers,
    )


def seq_of(text: str) -> int:
    return State.model_validate_json(text).seq


def test_a_slow_page_gets_the_newest_and_not_the_next() -> None:
    async def read() -> str:
        listener = StateListener()
        for text in ("one", "two", "three"):
            listener.put(text)
        newest = await listener.get()
        with pytest.raises(TimeoutError):
            await asyncio.wait_for(listener.get(), 0.02)
        return newest

    assert asyncio.run(read()) == "three"


def test_what_matters_is_told_at_once_and_the_rest_ten_times_a_second() -> None:
    async def listen() -> tuple[float, float]:
        feed = StateFeed()
        feeding = asyncio.create_task(feed.run(build))
        with feed.listen() as page:
            await page.get()
            await page.get()
            begun = time.monotonic()
            for _ in range(3):  # of which the first may be half over
                await page.get()
            calm = time.monotonic() - begun
            urgent = []
            for _ in range(5):
                await asyncio.sleep(0.03)  # past the least time between two states
                begun = time.monotonic()
                feed.changed()
                await page.get()
                urgent.append(time.monotonic() - begun)
        feeding.cancel()
        return calm, min(urgent)  # the best of some: a busy machine may hold one up

    calm, urgent = asyncio.run(listen())
    assert calm > 0.15
    assert urgent < 0.05


def test_nothing_is_built_while_nobody_listens() -> None:
    async def leave() -> tuple[int, int]:
        built = 0

        def counting(seq: int, viewers: int) -> State:
            nonlocal built
            built += 1
            return build(seq, viewers)

        feed = StateFeed()
        feeding = asyncio.create_task(feed.run(counting))
        with feed.listen() as page:
            assert seq_of(await page.get()) == 1
        await asyncio.sleep(0.15)  # the round that was under way ends
        before = built
        await asyncio.sleep(0.25)
        feeding.cancel()
        return before, built

    before, after = asyncio.run(leave())
    assert after == before


def test_two_that_matter_are_told_together_and_a_flood_of_them_fifty_times_a_second() -> None:
    async def listen() -> tuple[float, float]:
        feed = StateFeed()
        feeding = asyncio.create_task(feed.run(build))
        with feed.listen() as page:
            await page.get()
            second = []
            for _ in range(8):
                await page.get()
                await asyncio.sleep(0.05)  # longer than any state keeps the next one back
                feed.changed()
                await page.get()
                begun = time.monotonic()
                feed.changed()
                await page.get()
                second.append(time.monotonic() - begun)
            begun = time.monotonic()
            for _ in range(10):
                feed.changed()
                await page.get()
            flood = time.monotonic() - begun
        feeding.cancel()
        return min(second), flood  # the best of some: a busy machine may hold one up

    second, flood = asyncio.run(listen())
    assert second < 0.015
    assert flood > 0.15
