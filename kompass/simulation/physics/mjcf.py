"""The robot and its world as MuJoCo's model text (MJCF).

The robot is a differential drive of the TurtleBot3's proportions. ``base_link`` lies on the floor
midway between the wheels, x forward. What touches what is decided by collision bits, so that the
shell alone meets walls and pillars while wheels and casters alone meet the floor.
"""

from __future__ import annotations

import math
from xml.sax.saxutils import quoteattr

from kompass.simulation.physics.barriers import BARRIERS, BODY_RADIUS, Barrier
from kompass.simulation.physics.person import HEIGHT, PEOPLE, RADIUS
from kompass.simulation.worlds.shapes import Box, Shape
from kompass.simulation.worlds.world import World

BODY_HEIGHT = 0.20
BODY_MASS = 0.94  # kg, without the wheels
WHEEL_RADIUS = 0.033
WHEEL_SEPARATION = 0.16
WHEEL_MASS = 0.03
LIDAR_HEIGHT = 0.17  # above the floor, on the robot's axis
IMU_HEIGHT = 0.07

# The motors reach 0.3 m/s in about 0.15 s: 2 x 0.04 N·m / 0.033 m drive 1 kg with 2.4 m/s².
# That shifts the weight by less than the centre of mass lies behind the axle, so it never nods.
WHEEL_TORQUE = 0.04
WHEEL_GAIN = 0.05  # N·m per rad/s of speed error
_MASS_CENTER = (-0.02, 0.0, 0.06)
_CASTER_OFFSET = 0.075
_CASTER_RADIUS = 0.012
_FRONT_CASTER_GAP = 0.001  # the front caster only catches a nod

TIMESTEP = 0.002  # s

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


def model_text(world: World) -> str:
    """MJCF of ``world`` with the robot at its start pose."""
    solids = "\n".join(_solid(shape) for shape in world.solids)
    movable = "\n".join(
        [
            *map(_barrier, BARRIERS),
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
    {_robot(world.start)}
  </worldbody>
  <actuator>
    <velocity name="left" joint="left" kv="{WHEEL_GAIN}"
              forcerange="-{WHEEL_TORQUE} {WHEEL_TORQUE}"/>
    <velocity name="right" joint="right" kv="{WHEEL_GAIN}"
              forcerange="-{WHEEL_TORQUE} {WHEEL_TORQUE}"/>
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


def _robot(start: tuple[float, float, float]) -> str:
    x, y, yaw = start
    across = BODY_MASS * (3 * BODY_RADIUS**2 + BODY_HEIGHT**2) / 12
    upright = BODY_MASS * BODY_RADIUS**2 / 2
    com_x, com_y, com_z = _MASS_CENTER
    half = (BODY_HEIGHT - 0.01) / 2  # the shell ends 1 cm above the floor
    middle = 0.01 + half
    return f"""
    <body name="base_link" pos="{x} {y} 0" quat="{math.cos(yaw / 2)} 0 0 {math.sin(yaw / 2)}">
      <freejoint name="base"/>
      <inertial pos="{com_x} {com_y} {com_z}" mass="{BODY_MASS}"
                diaginertia="{across} {across} {upright}"/>
      <geom name="rear_caster" class="rolling" type="sphere" size="{_CASTER_RADIUS}" condim="1"
            friction="0" pos="-{_CASTER_OFFSET} 0 {_CASTER_RADIUS}"/>
      <geom name="front_caster" class="rolling" type="sphere" size="{_CASTER_RADIUS}" condim="1"
            friction="0" pos="{_CASTER_OFFSET} 0 {_CASTER_RADIUS + _FRONT_CASTER_GAP}"/>
      <site name="lidar" pos="0 0 {LIDAR_HEIGHT}"/>
      <site name="imu" pos="0 0 {IMU_HEIGHT}"/>
      <body name="shell">
        <geom name="shell" type="cylinder" size="{BODY_RADIUS} {half}" pos="0 0 {middle}" mass="0"
              contype="0" conaffinity="{_SOLID_BIT}" group="{ROBOT_GROUP}" friction="0.4"/>
        <site name="shell" type="cylinder" size="{1.5 * BODY_RADIUS} {1.5 * half}"
              pos="0 0 {middle}"/>
      </body>
      {_wheel("left", WHEEL_SEPARATION / 2)}
      {_wheel("right", -WHEEL_SEPARATION / 2)}
    </body>"""


def _wheel(name: str, y: float) -> str:
    # An ellipsoid touches the floor in one point, so turning on the spot does not scrub a line
    # of contact and the effective wheel separation is the nominal one.
    spin = WHEEL_MASS * WHEEL_RADIUS**2 / 2
    tumble = WHEEL_MASS * WHEEL_RADIUS**2 / 4
    return f"""
      <body name="{name}_wheel" pos="0 {y} {WHEEL_RADIUS}">
        <joint name="{name}" type="hinge" axis="0 1 0" damping="0.0001" armature="0.0001"/>
        <inertial pos="0 0 0" mass="{WHEEL_MASS}" diaginertia="{tumble} {spin} {tumble}"/>
        <geom name="{name}_wheel" class="rolling" type="ellipsoid" condim="3" friction="0.9"
              size="{WHEEL_RADIUS} 0.009 {WHEEL_RADIUS}"/>
      </body>"""
