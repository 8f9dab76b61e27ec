"""Missions for tests, and a time for them."""

from __future__ import annotations

from kompass.missions.mission import Mission, MissionPlan, Task, Waypoint
from kompass.missions.run import Now, Run
from kompass.places.place import MapIdentity

MAP = MapIdentity(id="0" * 32, label="4.0 × 3.0 m")


def plan(*tasks: tuple[Task, ...], **fields: object) -> MissionPlan:
    """A mission with a waypoint for each tuple of tasks; its places are 1, 2, 3 …"""
    waypoints = tuple(Waypoint(place=n, tasks=each) for n, each in enumerate(tasks, 1))
    return MissionPlan.model_validate(
        {"name": "Round", "map": MAP, "waypoints": waypoints, **fields}
    )


def mission(*tasks: tuple[Task, ...], **fields: object) -> Mission:
    """As :func:`plan`, kept."""
    kept = {"id": 1, "version": 1, "author": "ava", "role": "operator", "time": 0.0}
    return Mission.model_validate({**plan(*tasks, **fields).model_dump(), **kept})


def fresh(of: Mission) -> Run:
    """A run that has not begun."""
    return Run(number=1, mission=of, by="ava", started=0.0, phase="paused", since=0.0)


def at(seconds: float) -> Now:
    """So long after the beginning."""
    return Now(100.0 + seconds, 1e9 + seconds)
