"""Random goals in mapped worlds, in virtual time: arrivals, contacts, time, by follower.

.venv/bin/python benchmarks/mapped_goals.py [COUNT] [SEED] [WORLD,…] [FOLLOWER,…]

The shortest time is that of the planned way at full speed; goals are the same for each follower.
"""

import math
import random
import statistics
import sys
import time
from contextlib import closing
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
from tests.support.virtual_robot import VirtualRobot

RECIPE = Path(__file__).parent / "recipes" / "followed.py"
EXTENT = {"hexagon": 2.6, "apartment": 6.0, "warehouse": 10.0, "depot": 50.0}  # m from the middle
FULL_SPEED = 0.22  # m/s
PATIENCE = 900.0  # s for one goal
SUCCEEDED = 4


def main() -> None:
    given = [*sys.argv[1:], *[""] * 4]
    count, seed = int(given[0] or 20), int(given[1] or 1)
    worlds = given[2].split(",") if given[2] else list(EXTENT)
    followers = given[3].split(",") if given[3] else ["DWA", "MPPI", "PurePursuit"]
    for follower in followers:
        of_all: list[float] = []
        for place in worlds:
            told, shares = drive(place, follower, count, seed)
            print(f"{place:10s} {follower:11s} {told}", flush=True)
            of_all += shares
        print(f"all        {follower:11s} time over the shortest {statistics.median(of_all):.2f}")


def drive(place: str, follower: str, count: int, seed: int) -> tuple[str, list[float]]:
    """Send a robot to goals in a row; what became of it, and the time of each over the shortest."""
    chance, half = random.Random(seed), EXTENT[place]
    began = time.monotonic()
    failures: list[str] = []
    shares: list[float] = []
    offs: list[float] = []
    with closing(VirtualRobot(RECIPE, place=place, seed=seed, FOLLOWER=follower)) as robot:
        robot.ready()
        for number in range(1, count + 1):
            answer, x, y = None, 0.0, 0.0
            while answer is None or not answer.reachable or answer.length < 0.5:
                x, y = chance.uniform(-half, half), chance.uniform(-half, half)
                answer = robot.check(x, y)
            yaw = chance.uniform(-math.pi, math.pi)
            sent = robot.clock.monotonic()
            ended = robot.result(robot.send_goal(x, y, yaw), timeout=PATIENCE)
            off = robot.distance_to(x, y)
            if ended.status != SUCCEEDED or off > 0.10:
                failures.append(f"{number} ({x:.2f}, {y:.2f}): {ended.result.message}")
                continue
            shares.append((robot.clock.monotonic() - sent) / (answer.length / FULL_SPEED))
            offs.append(off)
        contacts, lived = robot.contacts, robot.clock.monotonic()
    told = "".join(f"\n    {each}" for each in failures)
    return (
        f"{count - len(failures)} of {count} arrived, {contacts} contacts; time over the shortest "
        f"{statistics.median(shares):.2f} (worst {max(shares):.2f}); off {100 * max(offs):.1f} cm "
        f"at worst; {lived / (time.monotonic() - began):.0f} x real time{told}",
        shares,
    )


if __name__ == "__main__":
    main()
