"""Random reachable goals in a row in the simulation: arrivals, contacts, restarts, errors.

.venv/bin/python benchmarks/random_goals.py [COUNT] [SEED] [WORLD]
"""

import math
import random
import statistics
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
from tests.support.robot import Robot
from tests.support.stack import Stack

EXTENT = {"hexagon": 2.6, "apartment": 6.0, "warehouse": 10.0}


def main() -> None:
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 20
    seed = int(sys.argv[2]) if len(sys.argv) > 2 else 1
    world = sys.argv[3] if len(sys.argv) > 3 else "hexagon"
    chance, half = random.Random(seed), EXTENT[world]
    stack = Stack.simulated(f"--sim={world}")
    robot = Robot(stack.domain)
    arrivals, distances, headings, shares = 0, [], [], []
    try:
        robot.ready()
        for number in range(1, count + 1):
            x = y = yaw = 0.0
            answer = None
            while answer is None or not answer.reachable:
                x, y = chance.uniform(-half, half), chance.uniform(-half, half)
                answer = robot.check(x, y)
            yaw = chance.uniform(-math.pi, math.pi)
            began = time.monotonic()
            ended = robot.result(robot.send_goal(x, y, yaw), timeout=300)
            took = time.monotonic() - began
            off = robot.distance_to(x, y)
            turned = abs(math.remainder(robot.truth[2] - yaw, 2 * math.pi))
            arrivals += ended.status == 4 and off < 0.10 and turned < 0.2
            distances.append(off)
            headings.append(turned)
            shares.append(took / answer.duration)
            print(
                f"{number:3} ({x:5.2f}, {y:5.2f}, {yaw:5.2f})  {answer.length:4.1f} m in "
                f"{took:4.0f} s  off {100 * off:3.1f} cm, {turned:.3f} rad  "
                f"contacts {robot.contacts}  {ended.result.message}",
                flush=True,
            )
        print(
            f"\n{arrivals} of {count} arrived within 0.10 m and 0.2 rad; "
            f"{robot.contacts} contacts; {stack.output.count('starts again')} restarts; off by "
            f"{100 * statistics.median(distances):.1f} cm (worst {100 * max(distances):.1f}), "
            f"{statistics.median(headings):.3f} rad (worst {max(headings):.3f}); time over the "
            f"estimate {statistics.median(shares):.2f} (worst {max(shares):.2f})"
        )
    finally:
        robot.close()
        stack.close()


if __name__ == "__main__":
    main()
