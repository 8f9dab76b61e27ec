"""Many who ask for the same thing: who makes the call, and whose answer they get."""

import asyncio

from kompass_console.web.joint_call import JointCall


class Robot:
    """Counts the calls; each is answered when it is told to be."""

    def __init__(self) -> None:
        self.answers: list[asyncio.Future[int]] = []

    async def call(self) -> int:
        self.answers.append(asyncio.get_running_loop().create_future())
        return await self.answers[-1]


async def settled() -> None:
    """Let everything happen that waits for nothing."""
    for _ in range(10):
        await asyncio.sleep(0)


def test_who_asks_while_a_call_is_under_way_gets_the_answer_of_the_next_one() -> None:
    async def many_ask() -> None:
        robot, joint = Robot(), JointCall[int](pause=0.0)
        first = asyncio.create_task(joint.ask(robot.call))
        await settled()
        later = [asyncio.create_task(joint.ask(robot.call)) for _ in range(1000)]
        await settled()
        assert len(robot.answers) == 1
        robot.answers[0].set_result(1)
        await settled()
        assert len(robot.answers) == 2
        assert not any(task.done() for task in later)
        robot.answers[1].set_result(2)
        assert await first == 1
        assert set(await asyncio.gather(*later)) == {2}
        assert len(robot.answers) == 2

    asyncio.run(many_ask())


def test_who_goes_away_takes_nobody_elses_answer_with_them() -> None:
    async def one_goes() -> None:
        robot, joint = Robot(), JointCall[int](pause=0.0)
        goes, stays = (asyncio.create_task(joint.ask(robot.call)) for _ in range(2))
        await settled()
        goes.cancel()
        await settled()
        robot.answers[0].set_result(7)
        assert await stays == 7

    asyncio.run(one_goes())


def test_a_failure_is_everybodys_and_the_next_call_is_made_all_the_same() -> None:
    async def one_fails() -> None:
        robot, joint = Robot(), JointCall[int](pause=0.0)
        both = [asyncio.create_task(joint.ask(robot.call)) for _ in range(2)]
        await settled()
        robot.answers[0].set_exception(TimeoutError("no answer"))
        told = await asyncio.gather(*both, return_exceptions=True)
        assert [type(each) for each in told] == [TimeoutError, TimeoutError]
        again = asyncio.create_task(joint.ask(robot.call))
        await settled()
        robot.answers[1].set_result(3)
        assert await again == 3

    asyncio.run(one_fails())


def test_between_the_beginnings_of_two_calls_there_is_a_pause() -> None:
    async def twice() -> None:
        now = [100.0]
        robot, joint = Robot(), JointCall[int](pause=3600.0, now=lambda: now[0])
        first = asyncio.create_task(joint.ask(robot.call))
        await settled()
        robot.answers[0].set_result(1)
        assert await first == 1
        waits = asyncio.create_task(joint.ask(robot.call))
        await settled()
        assert len(robot.answers) == 1
        waits.cancel()
        patient, later = Robot(), JointCall[int](pause=3600.0, now=lambda: now[0])
        for answer in (1, 2):
            asking = asyncio.create_task(later.ask(patient.call))
            await settled()
            patient.answers[-1].set_result(answer)
            assert await asking == answer
            now[0] += 3600.0
        assert len(patient.answers) == 2

    asyncio.run(twice())
