"""A robot is drawn as it describes itself; whatever it says, that costs little."""

import math
import os
from pathlib import Path

import numpy as np
import pytest

from kompass.simulation.description import description
from kompass.simulation.physics.robot_model import ACKERMANN, JACKAL, OMNI, TURTLEBOT3, RobotModel
from kompass_console.scene.layers.robot import RobotColours, body_of, by_colour
from kompass_console.scene.urdf import BadDescription, read_description

BOX = '<visual><geometry><box size="0.4 0.2 0.1"/></geometry></visual>'


def robot(inside: str) -> str:
    return f'<robot name="r">{inside}</robot>'


def link(name: str, inside: str = BOX) -> str:
    return f'<link name="{name}">{inside}</link>'


def mesh(filename: str) -> str:
    return f'<visual><geometry><mesh filename="{filename}"/></geometry></visual>'


def stl(path: Path, triangles: int = 1) -> Path:
    one = np.zeros(triangles, dtype=[("n", "<f4", 3), ("v", "<f4", (3, 3)), ("a", "<u2")])
    one["v"] = [(0, 0, 0), (1, 0, 0), (0, 0, 1)]
    path.write_bytes(b"\0" * 80 + triangles.to_bytes(4, "little") + one.tobytes())
    return path


@pytest.mark.parametrize(
    "kind", [TURTLEBOT3, JACKAL, ACKERMANN, OMNI], ids=lambda kind: str(kind.name)
)
def test_the_embedded_robots_describe_themselves_as_large_as_they_are(kind: RobotModel) -> None:
    found = read_description(description(kind))
    assert found.problems == ()
    corners = np.concatenate([solid.vertices for solid in found.solids])
    assert corners[:, 2].min() == pytest.approx(0.0, abs=1e-6)
    assert np.hypot(corners[:, 0], corners[:, 1]).max() <= kind.radius * 1.02
    assert 0.9 * kind.body_height < found.height < kind.body_height + 0.12
    assert len({solid.colour for solid in found.solids}) > 2


def test_a_link_stands_where_its_joints_put_it_and_the_whole_on_the_floor() -> None:
    joint = (
        '<joint name="j" type="fixed"><parent link="a"/><child link="b"/>'
        f'<origin xyz="1 0 0.5" rpy="0 0 {math.pi / 2}"/></joint>'
    )
    found = read_description(robot(link("a") + link("b") + joint))
    first, second = (solid.vertices for solid in found.solids)
    assert first.min(axis=0) == pytest.approx([-0.2, -0.1, 0.0], abs=1e-6)
    assert second.min(axis=0) == pytest.approx([0.9, -0.2, 0.5], abs=1e-6)
    assert second.max(axis=0) == pytest.approx([1.1, 0.2, 0.6], abs=1e-6)


def test_colours_are_those_of_its_materials() -> None:
    red = '<material name="red"><color rgba="1 0 0 1"/></material>'
    painted = BOX.replace("</visual>", '<material name="red"/></visual>')
    found = read_description(robot(red + link("a", painted + BOX)))
    assert [solid.colour for solid in found.solids] == [(255, 0, 0), None]


def test_a_mesh_is_read_from_a_file_of_this_machine_and_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = stl(tmp_path / "body.stl")
    opened: list[str] = []
    real = os.open

    def counted(name: str, *arguments: int) -> int:
        opened.append(os.fspath(name))
        return real(name, *arguments)

    monkeypatch.setattr(os, "open", counted)
    found = read_description(robot(link("a", mesh(f"file://{path}") * 50)))
    assert len(found.solids) == 50
    assert opened == [str(path)]


@pytest.mark.parametrize(
    ("filename", "complaint"),
    [
        ("http://example.org/body.stl", "only files of this machine"),
        ("package://nav/body.stl", "only files of this machine"),
        ("file://elsewhere/body.stl", "only files of this machine"),
        ("body.stl", "the whole path"),
        ("file:///tmp/../etc/passwd.stl", "the whole path"),
        ("file:///etc/passwd", "only STL"),
        ("file:///nowhere/at/all.stl", "No such file"),
        ("file://[x/body.stl", "Invalid IPv6 URL; give file:///"),
        ("file:///" + 5_000 * "a" + ".stl", "longer than 500 characters"),
    ],
)
def test_a_mesh_from_elsewhere_is_refused_in_a_sentence_and_the_rest_is_drawn(
    filename: str, complaint: str
) -> None:
    found = read_description(robot(link("a", mesh(filename) + BOX)))
    assert len(found.solids) == 1
    [problem] = found.problems
    assert complaint in problem


def test_what_is_no_file_is_never_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.stl")
    (tmp_path / "zero.stl").symlink_to("/dev/zero")
    text = robot(link("a", mesh(f"{tmp_path}/pipe.stl") + mesh(f"{tmp_path}/zero.stl") + BOX))
    problems = read_description(text).problems
    assert len(problems) == 2
    assert all("it is no file" in problem for problem in problems)


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("nothing", "no XML"),
        ("<robot>\ud800</robot>", "no XML"),
        ("<html/>", "no <robot>"),
        (robot(""), "nothing of it can be drawn"),
        (robot("<a>" * 40 + "</a>" * 40), "nested deeper"),
        (robot("<link/>" * 30_000), "more than 20000 elements"),
        (robot(" " * 1_000_000), "characters"),
        ('<!DOCTYPE r [<!ENTITY a "aaaa">]><robot>&a;</robot>', "document type"),
        (robot(link("a", BOX.replace("0.4 0.2 0.1", "1e9 1 1"))), "farther than"),
        (robot(link("a", BOX.replace("0.4", "nan"))), "three numbers"),
    ],
)
def test_what_cannot_be_drawn_is_refused_with_its_reason(text: str, complaint: str) -> None:
    with pytest.raises(BadDescription, match=complaint):
        read_description(text)


def test_a_hostile_megabyte_draws_no_more_than_its_share(tmp_path: Path) -> None:
    path = stl(tmp_path / "large.stl", 90_000)
    ring = "".join(
        f'<joint name="j{i}"><parent link="l{i}"/><child link="l{(i + 1) % 500}"/></joint>'
        for i in range(500)
    )
    links = "".join(link(f"l{i}", mesh(f"file://{path}")) for i in range(500))
    with pytest.raises(BadDescription):  # all of them in a ring: it has no root
        read_description(robot(links + ring))
    many = robot(link("a", mesh(f"file://{path}") * 4000))
    found = read_description(many)
    assert sum(len(solid.faces) for solid in found.solids) < 200_000
    assert len(found.problems) == 1


def test_a_robot_that_does_not_describe_itself_gets_a_body_inside_its_footprint() -> None:
    footprint = np.array([[0.3, 0.2], [0.3, -0.2], [-0.3, -0.2], [-0.3, 0.2]])
    colours = RobotColours(body=(40, 48, 58), front=(255, 255, 255), footprint=(58, 66, 76))
    solids = body_of(footprint, colours)
    corners = np.concatenate([solid.vertices for solid in solids])
    assert np.abs(corners[:, 0]).max() <= 0.3
    assert np.abs(corners[:, 1]).max() <= 0.2
    front = next(solid for solid in solids if solid.colour == colours.front)
    assert front.vertices[:, 0].max() > 0.2
    assert len(by_colour(solids, colours.body)) == 3
