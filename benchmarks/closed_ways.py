"""Ways that close while the robot drives them, in virtual time: round it, or why not; contacts.

.venv/bin/python benchmarks/closed_ways.py [DRIVES] [SEED] [FOLLOWER]

In turn a wall is put up 15 cm ahead of the robot at full speed, in a room with a way round it, and
a door closes before it is reached. What closes stays closed.
"""

from __future__ import annotations

import random
import sys
from collections import Counter

from benchmarks.drives import driven
from kompass.drills.scenario import Goal, Scenario, ScheduledFault

# A goal in each room of the apartment, and the door that leads there from the hall.
ROOMS = {
    "living": (2.45, 1.9),
    "kitchen": (6.85, 1.9),
    "bedroom": (1.65, 5.3),
    "study": (6.05, 5.3),
}
GOALS = ((1.7, 0.4), (-1.6, 0.6), (0.5, -1.7), (1.5, -1.0))  # in the hexagon
ROBOT = "turtlebot3"
LIMIT = 150.0  # s


def main() -> None:
    given = sys.argv[1:]
    drives = int(given[0]) if given else 20
    seed = int(given[1]) if len(given) > 1 else 1
    follower = given[2] if len(given) > 2 else "MPPI"
    planned = [scenario_of(number) for number in range(seed, seed + drives)]
    ends: Counter[str] = Counter()
    for (scenario, closed), found in zip(
        planned, driven((one for one, _ in planned), ROBOT, follower), strict=True
    ):
        (goal,) = found.goals
        contacts = len(found.contacts)
        ends[f"{closed} {goal.outcome}"] += 1
        ends["contacts"] += contacts
        ends["without a reason"] += not (goal.outcome == "arrived" or goal.message)
        print(
            f"seed {scenario.seed}: {closed}, {goal.outcome} after "
            f"{goal.ended or found.duration:.0f} s, {contacts} contacts: {goal.message}",
            flush=True,
        )
    told = ", ".join(f"{count} {what}" for what, count in sorted(ends.items()))
    print(f"\n{follower}, {drives} drives: {told}")


def scenario_of(seed: int) -> tuple[Scenario, str]:
    """One drive, and what closes in it."""
    chance = random.Random(seed)
    if seed % 2:
        x, y = chance.choice(GOALS)
        world, fault, closed = "hexagon", "way_blocked", "a wall"
        at = chance.uniform(2.0, 5.0)
    else:
        room, (x, y) = chance.choice(list(ROOMS.items()))
        world, fault, closed = "apartment", f"door_closed:{room}", "a door"
        at = chance.uniform(1.0, 8.0)
    scenario = Scenario(
        name=f"closed-{seed}",
        world=world,
        seed=seed,
        goals=(Goal(x=x, y=y, tolerance=0.1),),
        faults=(ScheduledFault(name=fault, at=at),),
        limit=LIMIT,
    )
    return scenario, closed


if __name__ == "__main__":
    main()
