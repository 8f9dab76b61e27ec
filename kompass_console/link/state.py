"""Puts together what the page is told, from what the link knows right now."""

from __future__ import annotations

import time

import numpy as np

from kompass_console.link.link import RosLink
from kompass_console.link.localisation import Localisation
from kompass_console.schema.control_models import ControlInfo
from kompass_console.schema.models import PoseInfo, RobotInfo, RosInfo, SimulationInfo, State
from kompass_console.schema.plain import plain
from kompass_console.schema.world import WorldModel


def robot_radius(world: WorldModel) -> float | None:
    """Radius (m) of the circle around the robot's footprint; None until that is known."""
    footprint = world.footprint.get()
    if footprint is None:
        return None
    return float(np.linalg.norm(footprint.value, axis=1).max())


def build_state(
    seq: int,
    robot_name: str,
    world: WorldModel,
    link: RosLink,
    localisation: Localisation,
    viewers: int,
    *,
    control: ControlInfo | None = None,
    audit_problem: str = "",
    webhook_problem: str = "",
) -> State:
    """One snapshot; ages are measured from when each value was received."""
    motion = world.motion.get()
    pose = None
    if motion is not None:
        m = motion.value
        pose = PoseInfo(x=m.pose.x, y=m.pose.y, yaw=m.pose.yaw, v=m.v, w=m.w, age=motion.age())
    rate = link.streams.simulation_rate
    streams = link.streams.infos()
    return State(
        seq=seq,
        time=time.time(),
        robot=RobotInfo(
            name=robot_name,
            radius=robot_radius(world),
            problem=plain(world.description_problem),
        ),
        pose=pose,
        localisation=localisation.info(),
        streams=streams,
        components=link.components.infos(
            link.processes.of,
            lambda name: link.component_topics.infos(name, streams),
            lambda name: link.component_topics.outputs(name, streams),
        ),
        drive=link.drive.info(),
        goal=link.goals.follower.info(),
        simulation=None if rate is None else SimulationInfo(rate=rate.value, age=rate.age()),
        battery=link.battery.info(),
        rules=link.rules.info(),
        places=link.places.info(),
        zones=link.zones.info(),
        missions=link.missions.info(),
        timeline=link.timeline.info(),
        log=link.rosout.info(),
        extras=link.on_demand.extras.infos(),
        cameras=link.on_demand.cameras.infos(),
        processes=link.processes.infos(),
        ros=RosInfo(domain_id=link.domain_id, middleware=link.middleware),
        viewers=viewers,
        control=control or ControlInfo(),
        audit_problem=audit_problem,
        webhook_problem=webhook_problem,
    )
