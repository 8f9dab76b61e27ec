"""What an embedded robot looks like, for whoever draws it: a URDF of the physics' measures."""

from __future__ import annotations

import math
from xml.sax.saxutils import quoteattr

from kompass.simulation.physics.robot_model import RobotModel

_COLOURS = {
    "body": (0.42, 0.48, 0.55),
    "deck": (0.62, 0.67, 0.73),
    "front": (0.96, 0.74, 0.26),
    "wheel": (0.16, 0.18, 0.21),
    "sensor": (0.12, 0.14, 0.16),
}
_CLEARANCE = 0.01  # m between the shell and the floor, as in the physics


def description(robot: RobotModel) -> str:
    """URDF of a robot in the frame ``base_link``: on the floor, x forward [m, rad]."""
    materials = "".join(
        f'<material name="{name}"><color rgba="{r} {g} {b} 1"/></material>'
        for name, (r, g, b) in _COLOURS.items()
    )
    links = _link("base_link", *_body(robot)) + _wheels(robot) + _sensor(robot)
    return f"<?xml version='1.0'?><robot name={quoteattr(robot.name)}>{materials}{links}</robot>"


def _body(robot: RobotModel) -> list[str]:
    """The shell, a deck on it and its front, which is told by place and shape as by colour."""
    top = robot.body_height
    lidar = min(0.03, top * 0.15)
    shell = top - _CLEARANCE - lidar
    middle = _CLEARANCE + shell / 2
    radius, box = robot.radius, robot.box
    nose_x = (radius if box is None else box[0] / 2) * 0.62
    nose = (nose_x * 0.55, (radius if box is None else box[1] * 0.775) * 0.36, 0.012)
    x = robot.middle + nose_x
    if box is None:
        # Above the wheels it is as wide as the footprint, between them it leaves them room.
        skirt = 1.8 * robot.wheel_radius
        size = f'<cylinder radius="{radius * 0.94}" length="{_CLEARANCE + shell - skirt}"/>'
        hub = f'<cylinder radius="{radius * 0.68}" length="{skirt - _CLEARANCE}"/>'
        low = [_visual(hub, "sensor", (0.0, 0.0, (skirt + _CLEARANCE) / 2))]
        middle = (_CLEARANCE + shell + skirt) / 2
        deck = f'<cylinder radius="{radius * 0.8}" length="0.01"/>'
    else:
        low = []
        width = box[1] * (0.8 if robot.steering is None else 0.55)  # a car's wheels are beside it
        size = f'<box size="{box[0] * 0.96} {width} {shell * 0.75}"/>'
        deck = f'<box size="{box[0] * 0.8} {box[1] * 0.62} {shell * 0.2}"/>'
    deck_z = top - lidar + 0.005 if box is None else _CLEARANCE + shell * 0.9
    nose_z = deck_z + (0.008 if box is None else shell * 0.1)
    return [
        *low,
        _visual(size, "body", (robot.middle, 0.0, middle)),
        _visual(deck, "deck", (robot.middle, 0.0, deck_z)),
        _visual('<box size="{} {} {}"/>'.format(*nose), "front", (x, 0.0, nose_z)),
        *_casters(robot),
    ]


def _casters(robot: RobotModel) -> list[str]:
    if robot.steering is not None or robot.omni is not None:
        return []
    shape = f'<sphere radius="{robot.caster_radius}"/>'
    return [
        _visual(shape, "wheel", (side * robot.caster_offset, 0.0, robot.caster_radius))
        for side in (-1, 1)
    ]


def _wheels(robot: RobotModel) -> str:
    radius, width = robot.wheel_radius, 2 * max(robot.wheel_edge, 0.009)
    shape = f'<cylinder radius="{radius}" length="{width}"/>'
    if robot.omni is not None:
        visuals = [
            _visual(
                shape,
                "wheel",
                (robot.omni.away * math.cos(at), robot.omni.away * math.sin(at), radius),
                # Its axle points away from the middle.
                (0.0, math.pi / 2, at),
            )
            for at in robot.omni.directions
        ]
        return _link("wheels", *visuals) + _joint("wheels", "fixed", (0.0, 0.0, 0.0))
    return "".join(_wheel(robot, side) for side in ("left", "right"))


def _wheel(robot: RobotModel, side: str) -> str:
    sign = 1 if side == "left" else -1
    radius, width = robot.wheel_radius, 2 * max(robot.wheel_edge, 0.009)
    along = (0.0,) if robot.box is None else (-robot.box[0] * 0.28, robot.box[0] * 0.28)
    # A box on four wheels is driven by two in the physics; it is drawn as it is built.
    if robot.steering is not None:
        along = (0.0, robot.steering.wheel_base)
    visuals = [
        _visual(
            f'<cylinder radius="{radius}" length="{width}"/>',
            "wheel",
            (x, 0.0, 0.0),
            (math.pi / 2, 0.0, 0.0),
        )
        for x in along
    ]
    name = f"{side}_wheel"
    place = (0.0, sign * robot.wheel_separation / 2, radius)
    return _link(name, *visuals) + _joint(name, "continuous", place)


def _sensor(robot: RobotModel) -> str:
    radius = min(0.035 if robot.box is None else 0.06, robot.radius * 0.4)
    height = 0.035 if robot.box is None else 0.07
    visual = _visual(f'<cylinder radius="{radius}" length="{height}"/>', "sensor", (0.0, 0.0, 0.0))
    # The turning head stands on the deck, at the height of its plane or just above the body.
    z = max(robot.lidar.height, robot.body_height - height / 2 + 0.01)
    return _link("lidar", visual) + _joint("lidar", "fixed", (0.0, 0.0, z))


def _link(name: str, *visuals: str) -> str:
    return f"<link name={quoteattr(name)}>{''.join(visuals)}</link>"


def _joint(child: str, kind: str, place: tuple[float, float, float]) -> str:
    axis = '<axis xyz="0 1 0"/>' if kind == "continuous" else ""
    return (
        f'<joint name="{child}_joint" type="{kind}"><parent link="base_link"/>'
        f'<child link="{child}"/>{_origin(place, (0.0, 0.0, 0.0))}{axis}</joint>'
    )


def _visual(
    shape: str,
    material: str,
    place: tuple[float, float, float],
    turned: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> str:
    return (
        f"<visual>{_origin(place, turned)}<geometry>{shape}</geometry>"
        f'<material name="{material}"/></visual>'
    )


def _origin(place: tuple[float, float, float], turned: tuple[float, float, float]) -> str:
    xyz, rpy = (" ".join(f"{part:.5g}" for part in parts) for parts in (place, turned))
    return f'<origin xyz="{xyz}" rpy="{rpy}"/>'
