"""A robot's own description (URDF) as solids to draw: bounded, whatever it says.

Anybody on the robot's network can publish a description. So its size, depth and number of parts
are limited, entities are refused, and of meshes only regular files of this machine are read: each
once, up to a size, and never from the network.
"""

from __future__ import annotations

import math
import os
import stat
import xml.parsers.expat
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import unquote, urlsplit

import numpy as np
import numpy.typing as npt

from kompass_console.scene.layers.palette import Rgb
from kompass_console.scene.layers.shapes import Faces, Vertices

LONGEST = 1_000_000  # characters
_DEEPEST = 30  # elements inside each other
_MOST_ELEMENTS = 20_000
_MOST_PARTS = 300
_MOST_TRIANGLES = 100_000
_LARGEST_MESH = 84 + 50 * _MOST_TRIANGLES  # bytes of a file
_MOST_MESHES = 40  # files
_LONGEST_NAME = 500  # characters of a mesh's name
_FARTHEST = 50.0  # m from the base; beyond it is no part of a robot
_ROUND = 24  # corners of a circle

_Matrix = npt.NDArray[np.float64]


class BadDescription(ValueError):
    """It is no description that can be drawn; the message says why, in a sentence."""


@dataclass(frozen=True, slots=True)
class Solid:
    """Triangles of one colour in the robot's frame, m; `colour` is None where none is said."""

    vertices: Vertices
    faces: Faces
    colour: Rgb | None


@dataclass(frozen=True, slots=True)
class Description:
    """What a robot looks like, standing on the floor, and what of it was left out and why."""

    solids: tuple[Solid, ...]
    problems: tuple[str, ...]

    @property
    def height(self) -> float:
        """Of its highest point above the floor, m."""
        return max(float(solid.vertices[:, 2].max()) for solid in self.solids)


def read_description(text: str) -> Description:
    """The solids of a URDF, joints at zero.

    Raises
    ------
    BadDescription
        When it is too large, no XML, no URDF, or has nothing that can be drawn.
    """
    if len(text) > LONGEST:
        raise BadDescription(
            f"it has {len(text)} characters, and at most {LONGEST} are read; leave meshes in files"
        )
    return _Reader(_parse(text)).read()


# -- XML ------------------------------------------------------------------------------------------


@dataclass(slots=True)
class _Element:
    name: str
    attributes: dict[str, str]
    children: list[_Element] = field(default_factory=list)

    def all(self, name: str) -> list[_Element]:
        return [child for child in self.children if child.name == name]

    def first(self, name: str) -> _Element | None:
        return next((child for child in self.children if child.name == name), None)


def _parse(text: str) -> _Element:
    root = _Element("", {})
    path = [root]
    count = 0

    def begin(name: str, attributes: dict[str, str]) -> None:
        nonlocal count
        count += 1
        if count > _MOST_ELEMENTS:
            raise BadDescription(f"it has more than {_MOST_ELEMENTS} elements; simplify it")
        if len(path) > _DEEPEST:
            raise BadDescription(f"its elements are nested deeper than {_DEEPEST}; flatten it")
        element = _Element(name, attributes)
        path[-1].children.append(element)
        path.append(element)

    def end(_name: str) -> None:
        path.pop()

    def declared(*_: object) -> None:
        # An entity can stand for a thousand others, or for a file.
        raise BadDescription("it declares a document type, which is not read; leave <!DOCTYPE out")

    parser = xml.parsers.expat.ParserCreate()
    parser.StartElementHandler = begin
    parser.EndElementHandler = end
    parser.StartDoctypeDeclHandler = declared
    try:
        parser.Parse(text, True)
    except (xml.parsers.expat.ExpatError, UnicodeEncodeError) as error:
        raise BadDescription(f"it is no XML: {error}; publish the URDF itself, not xacro") from None
    robot = root.first("robot")
    if robot is None:
        raise BadDescription("its root is no <robot>; publish a URDF")
    return robot


# -- URDF -----------------------------------------------------------------------------------------


class _Reader:
    """Collects the solids of a <robot>."""

    def __init__(self, robot: _Element) -> None:
        self._robot = robot
        self._colours = {
            material.attributes.get("name", ""): colour
            for material in robot.all("material")
            if (colour := _colour(material)) is not None
        }
        self._meshes: dict[Path, Vertices] = {}
        self._refused: dict[str, str] = {}
        self._triangles = 0

    def read(self) -> Description:
        solids: list[Solid] = []
        problems: list[str] = []
        for link, pose in self._placed():
            for visual in link.all("visual"):
                if len(solids) == _MOST_PARTS:
                    problems.append(f"only the first {_MOST_PARTS} of its parts are drawn")
                    break
                try:
                    solids.append(self._solid(visual, pose))
                except _LeftOut as error:
                    problems.append(str(error))
            else:
                continue
            break
        if not solids:
            why = f": {problems[0]}" if problems else "; add <visual> elements"
            raise BadDescription(f"nothing of it can be drawn{why}")
        return Description(_on_the_floor(solids), tuple(dict.fromkeys(problems)))

    def _placed(self) -> Iterator[tuple[_Element, _Matrix]]:
        """Each link with its pose in the frame of the root link."""
        links = {link.attributes.get("name", ""): link for link in self._robot.all("link")}
        below: dict[str, list[tuple[str, _Matrix]]] = {}
        children = set()
        for joint in self._robot.all("joint"):
            parent, child = (_link_of(joint, end) for end in ("parent", "child"))
            below.setdefault(parent, []).append((child, _origin(joint)))
            children.add(child)
        waiting = [(name, np.eye(4)) for name in links if name not in children][:1]
        seen: set[str] = set()
        while waiting:
            name, pose = waiting.pop()
            if name in seen or name not in links:
                continue
            seen.add(name)
            yield links[name], pose
            waiting += [(child, pose @ step) for child, step in below.get(name, [])]

    def _solid(self, visual: _Element, pose: _Matrix) -> Solid:
        if self._triangles > _MOST_TRIANGLES:
            raise _LeftOut(
                f"it has more than {_MOST_TRIANGLES} triangles, and the rest is not drawn; "
                "simplify its meshes"
            )
        geometry = visual.first("geometry")
        shape = geometry.children[0] if geometry is not None and geometry.children else None
        if shape is None:
            raise _LeftOut("a part without a shape is not drawn")
        vertices, faces = self._shape(shape)
        self._triangles += len(faces)
        matrix = pose @ _origin(visual)
        moved = vertices @ matrix[:3, :3].T + matrix[:3, 3]
        if not np.isfinite(moved).all() or np.abs(moved).max() > _FARTHEST:
            raise _LeftOut(f"a part farther than {_FARTHEST:g} m from the robot is not drawn")
        material = visual.first("material")
        colour = None
        if material is not None:
            colour = _colour(material) or self._colours.get(material.attributes.get("name", ""))
        return Solid(moved.astype(np.float32), faces, colour)

    def _shape(self, shape: _Element) -> tuple[npt.NDArray[np.float64], Faces]:
        if shape.name == "box":
            return _box(_numbers(shape, "size", "0.1 0.1 0.1"))
        if shape.name == "cylinder":
            return _cylinder(_number(shape, "radius"), _number(shape, "length"))
        if shape.name == "sphere":
            return _sphere(_number(shape, "radius"))
        if shape.name == "mesh":
            triangles = self._mesh(shape.attributes.get("filename", ""))
            scaled = triangles.astype(np.float64) * _numbers(shape, "scale", "1 1 1")
            return scaled, np.arange(len(scaled), dtype=np.uint32).reshape(-1, 3)
        raise _LeftOut(f"a {shape.name[:40]!r} is no shape that can be drawn")

    def _mesh(self, name: str) -> Vertices:
        """Corners (3 N, 3) of a mesh's triangles; every file is opened once, good or bad."""
        if name not in self._refused:
            try:
                path = _file_of(name)
                if path not in self._meshes:
                    if len(self._meshes) + len(self._refused) >= _MOST_MESHES:
                        raise _LeftOut(f"only the first {_MOST_MESHES} of its meshes are read")
                    self._meshes[path] = _stl(path)
                return self._meshes[path]
            except _LeftOut as error:
                self._refused[name] = str(error)
        raise _LeftOut(self._refused[name])


class _LeftOut(Exception):
    """A part is not drawn; the message says why, in a sentence."""


def _link_of(joint: _Element, end: str) -> str:
    element = joint.first(end)
    return "" if element is None else element.attributes.get("link", "")


def _numbers(element: _Element, name: str, default: str) -> npt.NDArray[np.float64]:
    text = element.attributes.get(name, default)
    try:
        found = np.array([float(part) for part in text.split()])
    except ValueError:
        found = np.zeros(0)
    if found.shape != (3,) or not np.isfinite(found).all():
        raise _LeftOut(f"{element.name} {name}={text[:40]!r} is not drawn: give three numbers")
    return found


def _number(element: _Element, name: str) -> float:
    text = element.attributes.get(name, "")
    try:
        found = float(text)
    except ValueError:
        found = math.nan
    if not 0.0 < found < _FARTHEST:
        raise _LeftOut(f"{element.name} {name}={text[:40]!r} is not drawn: give metres above 0")
    return found


def _origin(element: _Element) -> _Matrix:
    """Pose that an element's <origin> gives, (4, 4); at the place of its parent without one."""
    matrix = np.eye(4)
    origin = element.first("origin")
    if origin is None:
        return matrix
    try:
        matrix[:3, 3] = _numbers(origin, "xyz", "0 0 0")
        roll, pitch, yaw = _numbers(origin, "rpy", "0 0 0")
    except _LeftOut as error:
        raise BadDescription(f"{error}") from None
    cr, sr, cp, sp = math.cos(roll), math.sin(roll), math.cos(pitch), math.sin(pitch)
    cy, sy = math.cos(yaw), math.sin(yaw)
    matrix[:3, :3] = [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
    return matrix


def _colour(material: _Element) -> Rgb | None:
    colour = material.first("color")
    if colour is None:
        return None
    try:
        red, green, blue, *_ = (float(part) for part in colour.attributes.get("rgba", "").split())
    except ValueError:
        return None
    parts = [
        min(max(part, 0.0), 1.0) if math.isfinite(part) else 0.0 for part in (red, green, blue)
    ]
    return round(255 * parts[0]), round(255 * parts[1]), round(255 * parts[2])


def _on_the_floor(solids: list[Solid]) -> tuple[Solid, ...]:
    """Lifted so that its lowest point is on the floor: many a base frame is at the axles."""
    low = min(float(solid.vertices[:, 2].min()) for solid in solids)
    up = np.array([0.0, 0.0, -low], dtype=np.float32)
    return tuple(Solid(solid.vertices + up, solid.faces, solid.colour) for solid in solids)


# -- shapes ---------------------------------------------------------------------------------------


def _box(size: npt.NDArray[np.float64]) -> tuple[npt.NDArray[np.float64], Faces]:
    corners = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * size / 2
    faces = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1)]
    faces += [(2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]
    return corners, np.array(faces, dtype=np.uint32)


def _cylinder(radius: float, length: float) -> tuple[npt.NDArray[np.float64], Faces]:
    return _turned(
        [(0.0, -length / 2), (radius, -length / 2), (radius, length / 2), (0.0, length / 2)]
    )


def _sphere(radius: float) -> tuple[npt.NDArray[np.float64], Faces]:
    angles = np.linspace(-math.pi / 2, math.pi / 2, _ROUND // 2 + 1)
    return _turned([(radius * math.cos(a), radius * math.sin(a)) for a in angles])


def _turned(profile: list[tuple[float, float]]) -> tuple[npt.NDArray[np.float64], Faces]:
    """A profile of (radius, z) turned around the z axis."""
    angles = np.linspace(0.0, 2.0 * math.pi, _ROUND, endpoint=False)
    rings = [
        np.column_stack([r * np.cos(angles), r * np.sin(angles), np.full(_ROUND, z)])
        for r, z in profile
    ]
    faces = []
    for ring in range(len(profile) - 1):
        for corner in range(_ROUND):
            a, b = ring * _ROUND + corner, ring * _ROUND + (corner + 1) % _ROUND
            faces += [(a, b, b + _ROUND), (a, b + _ROUND, a + _ROUND)]
    return np.concatenate(rings), np.array(faces, dtype=np.uint32)


# -- meshes ---------------------------------------------------------------------------------------


def _file_of(name: str) -> Path:
    """The file of this machine that a mesh's name means."""
    shown = name[:_LONGEST_NAME]
    try:
        parts = urlsplit(name)
    except ValueError as error:
        raise _LeftOut(
            f"the mesh {shown!r} is not drawn: {error}; give file:///… with its whole path"
        ) from None
    if parts.scheme not in ("", "file") or parts.netloc not in ("", "localhost"):
        raise _LeftOut(
            f"the mesh {shown!r} is not drawn: only files of this machine are read; give "
            "file:///… with its whole path"
        )
    path = Path(unquote(parts.path))
    if not path.is_absolute() or ".." in path.parts or "\0" in str(path):
        raise _LeftOut(f"the mesh {shown!r} is not drawn: give the whole path, without '..'")
    if len(str(path)) > _LONGEST_NAME:
        raise _LeftOut(
            f"the mesh {shown!r}… is not drawn: its path is longer than {_LONGEST_NAME} characters"
        )
    if path.suffix.lower() != ".stl":
        raise _LeftOut(f"the mesh {shown!r} is not drawn: only STL files are read; convert it")
    return path


def _stl(path: Path) -> Vertices:
    """Corners (3 N, 3) of the triangles of a binary STL file."""
    try:
        # What is no file (a pipe, a device) must not keep us waiting, nor be opened at all.
        if not stat.S_ISREG(path.stat().st_mode):
            raise _LeftOut(f"the mesh {path} is not drawn: it is no file")
        descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
        with os.fdopen(descriptor, "rb") as file:
            data = file.read(_LARGEST_MESH + 1)
    except OSError as error:
        why = error.strerror or "it cannot be read"
        raise _LeftOut(f"the mesh {path} is not drawn: {why}; look at its path") from None
    if len(data) > _LARGEST_MESH:
        raise _LeftOut(
            f"the mesh {path} is not drawn: it is larger than {_LARGEST_MESH // 1_000_000} MB; "
            "simplify it"
        )
    count = int.from_bytes(data[80:84], "little")
    if len(data) < 84 or len(data) != 84 + 50 * count or count == 0:
        raise _LeftOut(f"the mesh {path} is not drawn: it is no binary STL; convert it")
    if count > _MOST_TRIANGLES:
        raise _LeftOut(f"the mesh {path} is not drawn: it has {count} triangles; simplify it")
    rows = np.frombuffer(data, dtype=np.uint8, offset=84).reshape(count, 50)
    corners = np.ascontiguousarray(rows[:, 12:48]).view("<f4").reshape(-1, 3)
    if not np.isfinite(corners).all():
        raise _LeftOut(f"the mesh {path} is not drawn: some of its numbers are not finite")
    return corners.astype(np.float32)
