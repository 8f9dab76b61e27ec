"""The robot and its world as MuJoCo's model text (MJCF).

What touches what is decided by collision bits, so that the robot's shell alone meets walls and
pillars while its wheels and casters alone meet the floor.
"""

from __future__ import annotations

import math
from xml.sax.saxutils import quoteattr

from kompass.simulation.physics.barriers import Barrier, Barriers
from kompass.simulation.physics.person import HEIGHT, PEOPLE, RADIUS
from kompass.simulation.physics.robot_model import TURTLEBOT3, RobotModel
from kompass.simulation.worlds.shapes import Box, Shape
from kompass.simulation.worlds.world import World

TIMESTEP = 0.002  # s

# What the physics calls the wheels that the robot is driven by.
DRIVEN_WHEELS = ("left", "right")
OMNI_WHEELS = (*DRIVEN_WHEELS, "behind")

STORE = -10.0  # m; where walls, doors and people are that are not up, far below the floor

# Geom groups, by which the lidar's rays tell solids from the floor and from the robot itself.
SOLID_GROUP, FLOOR_GROUP, ROBOT_GROUP, GLASS_GROUP = 0, 1, 2, 3
_FLOOR_BIT, _SOLID_BIT = 1, 2


def solid_geom(name: str) -> str:
    """What the physics calls a wall or obstacle of the world."""
    return f"solid {name}"


def door_body(name: str) -> str:
    """What the physics calls the door of a doorway."""
    return f"door {name}"


def model_text(world: World, robot: RobotModel = TURTLEBOT3) -> str:
    """MJCF of ``world`` with the robot at its start pose."""
    solids = "\n".join(_solid(shape) for shape in world.solids)
    barriers = Barriers(robot.radius)
    low = barriers.low if robot.camera is not None else ()
    movable = "\n".join(
        [
            *map(_barrier, (*barriers.all, *low)),
            *(
                _movable(door_body(door.name), _box(door.size, door.height), door.height)
                for door in world.doorways
            ),
            *(_movable(name, _cylinder(RADIUS, HEIGHT), HEIGHT) for name in PEOPLE),
        ]
    )
    return f"""
<mujoco model={quoteattr(world.name)}>
  <compiler angle="radian" autolimits="true"/>
  <option timestep="{TIMESTEP}" integrator="implicitfast" cone="elliptic" impratio="10">
    <!-- With one robot and some dozen solids, sorting them out costs more than it saves: a sixth
         of each step, for the same result to the last bit. -->
    <flag midphase="disable" island="disable"/>
  </option>
  <default>
    <!-- As stiff as the time step allows: the robot stands upright to 0.01 degrees. -->
    <geom solref="0.005 1"/>
    <default class="solid">
      <geom contype="{_SOLID_BIT}" conaffinity="0" group="{SOLID_GROUP}" friction="0.4"/>
    </default>
    <default class="rolling">
      <geom contype="0" conaffinity="{_FLOOR_BIT}" group="{ROBOT_GROUP}" mass="0"/>
    </default>
  </default>
  <worldbody>
    <!-- A pair takes the larger friction and dimension of its two geoms, so an ideally slippery
         floor leaves the choice to what rolls on it: grip for the wheels, none for the casters. -->
    <geom name="floor" type="plane" size="0 0 1" contype="{_FLOOR_BIT}" conaffinity="0"
          group="{FLOOR_GROUP}" condim="1" friction="0"/>
    {solids}
    {movable}
    {_robot(robot, world.start)}
  </worldbody>
  <actuator>
    {_motors(robot)}
  </actuator>
  <sensor>
    <touch name="shell" site="shell"/>
    <accelerometer name="accelerometer" site="imu"/>
    <gyro name="gyro" site="imu"/>
    <framequat name="orientation" objtype="site" objname="imu"/>
  </sensor>
</mujoco>
"""


def _solid(shape: Shape) -> str:
    x, y = shape.center
    place = f'pos="{x} {y} {shape.height / 2}"'
    if isinstance(shape, Box):
        form = f'{_box(shape.size, shape.height)} euler="0 0 {shape.yaw}"'
    else:
        form = _cylinder(shape.radius, shape.height)
    return f'<geom class="solid" name={quoteattr(solid_geom(shape.name))} {form} {place}/>'


def _barrier(barrier: Barrier) -> str:
    return _movable(
        barrier.name, _box((barrier.thickness, barrier.length), barrier.height), barrier.height
    )


def _movable(name: str, form: str, height: float) -> str:
    """What can be put anywhere, and lies in the store until then."""
    return f"""
    <body name={quoteattr(name)} mocap="true" pos="0 0 {STORE}">
      <geom class="solid" name={quoteattr(name)} {form} pos="0 0 {height / 2}"/>
    </body>"""


def _box(size: tuple[float, float], height: float) -> str:
    return f'type="box" size="{size[0] / 2} {size[1] / 2} {height / 2}"'


def _cylinder(radius: float, height: float) -> str:
    return f'type="cylinder" size="{radius} {height / 2}"'


def _robot(robot: RobotModel, start: tuple[float, float, float]) -> str:
    x, y, yaw = start
    com_x, com_y, com_z = robot.mass_center
    half = (robot.body_height - 0.01) / 2  # the shell ends 1 cm above the floor
    middle = 0.01 + half
    ahead = robot.middle
    return f"""
    <body name="base_link" pos="{x} {y} 0" quat="{math.cos(yaw / 2)} 0 0 {math.sin(yaw / 2)}">
      <freejoint name="base"/>
      <inertial pos="{com_x} {com_y} {com_z}" mass="{robot.body_mass}"
                diaginertia="{_inertia(robot)}"/>
      {_casters(robot)}
      <site name="lidar" pos="0 0 {robot.lidar.height}"/>
      <site name="imu" pos="0 0 {robot.imu_height}"/>
      {_more_sensors(robot)}
      <body name="shell">
        <geom name="shell" {_shell(robot, half)} pos="{ahead} 0 {middle}" mass="0"
              contype="0" conaffinity="{_SOLID_BIT}" group="{ROBOT_GROUP}" friction="0.4"/>
        <site name="shell" {_shell(robot, half, 1.5)}
              pos="{ahead} 0 {middle}"/>
      </body>
      {_wheels(robot)}
    </body>"""


def _motors(robot: RobotModel) -> str:
    """What drives and steers; in the order in which a drive says what is wanted of each."""
    gain, torque = robot.wheel_gain, robot.wheel_torque
    force = f'forcerange="-{torque} {torque}"'
    if robot.omni is not None:
        # An omni wheel pulls along its rim, and across it there is nothing that holds it.
        gear = f'gear="{1 / robot.wheel_radius} 0 0 0 0 0"'
        return "\n    ".join(
            f'<velocity name="{name}" site="{name}" {gear} kv="{gain}" {force}/>'
            for name in OMNI_WHEELS
        )
    motors = [
        f'<velocity name="{name}" joint="{name}" kv="{gain}" {force}/>' for name in DRIVEN_WHEELS
    ]
    if robot.steering is not None:
        servo = f'kp="{robot.steering.gain}" dampratio="1"'
        motors += [
            f'<position name="{name}_steer" joint="{name}_steer" {servo}/>'
            for name in DRIVEN_WHEELS
        ]
    return "\n    ".join(motors)


def _casters(robot: RobotModel) -> str:
    """What the robot stands on besides its wheels, without friction."""
    radius, away = robot.caster_radius, robot.caster_offset
    if robot.steering is not None:
        return ""  # it stands on four wheels
    places = [(-away, 0.0, radius), (away, 0.0, radius + robot.front_caster_gap)]
    if robot.omni is not None:
        # Its wheels pull, and are not made to roll on the floor.
        places += [(0.0, -away, radius), (0.0, away, radius)]
    names = ("rear_caster", "front_caster", "right_caster", "left_caster")
    return "\n      ".join(
        f'<geom name="{name}" class="rolling" type="sphere" size="{radius}" condim="1" '
        f'friction="0" pos="{x} {y} {z}"/>'
        for name, (x, y, z) in zip(names, places, strict=False)
    )


def _wheels(robot: RobotModel) -> str:
    if robot.omni is not None:
        # They pull at the height of the centre of mass, so that the robot does not nod.
        height, away = robot.mass_center[2], robot.omni.away
        return "\n      ".join(
            f'<site name="{name}" euler="0 0 {direction + math.pi / 2}" '
            f'pos="{away * math.cos(direction)} {away * math.sin(direction)} {height}"/>'
            for name, direction in zip(OMNI_WHEELS, robot.omni.directions, strict=True)
        )
    half = robot.wheel_separation / 2
    wheels = [_wheel(robot, "left", half), _wheel(robot, "right", -half)]
    if robot.steering is not None:
        base = robot.steering.wheel_base
        wheels += [_steered(robot, "left", base, half), _steered(robot, "right", base, -half)]
    return "\n      ".join(wheels)


def _more_sensors(robot: RobotModel) -> str:
    """Where the sensors are that not every robot has."""
    sites = []
    if robot.rear is not None:
        place = f"-{robot.rear.behind} 0 {robot.rear.lidar.height}"
        sites.append(f'<site name="rear" pos="{place}" euler="0 0 {math.pi}"/>')
    if robot.camera is not None:
        place = f"{robot.camera.ahead} 0 {robot.camera.height}"
        sites.append(f'<site name="camera" pos="{place}" euler="0 {robot.camera.down} 0"/>')
    return "\n      ".join(sites)


def _shell(robot: RobotModel, half: float, times: float = 1) -> str:
    if robot.box is None:
        return f'type="cylinder" size="{times * robot.radius} {times * half}"'
    length, width = robot.box
    return f'type="box" size="{times * length / 2} {times * width / 2} {times * half}"'


def _inertia(robot: RobotModel) -> str:
    """About the three axes of the body [kg m²], of one that is solid throughout."""
    mass, height = robot.body_mass, robot.body_height
    if robot.box is None:
        across = mass * (3 * robot.radius**2 + height**2) / 12
        return f"{across} {across} {mass * robot.radius**2 / 2}"
    length, width = robot.box
    sides = (width, height), (length, height), (length, width)
    return " ".join(str(mass * (a**2 + b**2) / 12) for a, b in sides)


def _steered(robot: RobotModel, name: str, x: float, y: float) -> str:
    """A wheel ahead that rolls freely, on a knuckle that turns."""
    radius, mass = robot.wheel_radius, robot.wheel_mass
    turned = mass * radius**2 / 4
    return f"""
      <body name="{name}_knuckle" pos="{x} {y} {radius}">
        <joint name="{name}_steer" type="hinge" axis="0 0 1" armature="0.01"/>
        <inertial pos="0 0 0" mass="0.1" diaginertia="{turned} {turned} {turned}"/>
        {_wheel(robot, f"{name}_front", 0.0, -radius)}
      </body>"""


def _wheel(robot: RobotModel, name: str, y: float, lower: float = 0.0) -> str:
    # An ellipsoid touches the floor in one point, so turning on the spot does not scrub a line
    # of contact and the effective wheel separation is the nominal one.
    radius, mass = robot.wheel_radius, robot.wheel_mass
    spin = mass * radius**2 / 2
    tumble = mass * radius**2 / 4
    return f"""
      <body name="{name}_wheel" pos="0 {y} {radius + lower}">
        <joint name="{name}" type="hinge" axis="0 1 0" damping="0.0001" armature="0.0001"/>
        <inertial pos="0 0 0" mass="{mass}" diaginertia="{tumble} {spin} {tumble}"/>
        <geom name="{name}_wheel" class="rolling" type="ellipsoid" condim="3" friction="0.9"
              size="{radius} {robot.wheel_edge} {radius}"/>
      </body>"""
