"""People who cross the robot's way, in virtual time: contacts, arrivals, and how long it took.

.venv/bin/python benchmarks/people_crossing.py [DRIVES] [SEED] [FOLLOWER] [ROBOT]

Each drive has three goals in the hexagon and somebody crossing the way ahead every four seconds.
Nobody walks into the robot: whoever comes too near to it waits, so a contact is the robot's doing.
"""

from __future__ import annotations

import sys

from benchmarks.drives import driven
from kompass.drills.scenario import Goal, Scenario, ScheduledFault

GOALS = ((1.7, 0.4), (-1.6, 0.6), (0.5, -1.7))
EVERY, UNTIL = 4.0, 60.0  # s
LIMIT = 150.0  # s


def main() -> None:
    given = sys.argv[1:]
    drives = int(given[0]) if given else 20
    seed = int(given[1]) if len(given) > 1 else 1
    follower = given[2] if len(given) > 2 else "MPPI"
    robot = given[3] if len(given) > 3 else "turtlebot3"
    encounters = contacts = arrived = goals = 0
    planned = [scenario_of(number) for number in range(seed, seed + drives)]
    for scenario, found in zip(planned, driven(planned, robot, follower), strict=True):
        met, touched = len(found.faults), len(found.contacts)
        reached = sum(goal.outcome == "arrived" for goal in found.goals)
        took = max((goal.ended or found.duration for goal in found.goals), default=0.0)
        encounters, contacts = encounters + met, contacts + touched
        arrived, goals = arrived + reached, goals + len(GOALS)
        print(
            f"seed {scenario.seed}: {met} people, {touched} contacts, "
            f"{reached} of {len(GOALS)} goals in {took:.0f} s: {found.why}",
            flush=True,
        )
    print(
        f"\n{robot}, {follower}: {encounters} people crossed; {contacts} contacts; "
        f"{arrived} of {goals} goals reached"
    )


def scenario_of(seed: int) -> Scenario:
    """One drive."""
    crossing = tuple(
        ScheduledFault(name="person_crossing", at=3.0 + EVERY * index, duration=EVERY - 0.1)
        for index in range(int(UNTIL / EVERY))
    )
    return Scenario(
        name=f"people-{seed}",
        world="hexagon",
        seed=seed,
        goals=tuple(Goal(x=x, y=y, tolerance=0.1) for x, y in GOALS),
        faults=crossing,
        limit=LIMIT,
    )


if __name__ == "__main__":
    main()
