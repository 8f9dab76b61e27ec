"""A file of a path is read as it was saved, or refused with field, value and remedy."""

import json
import os
from pathlib import Path

import numpy as np
import pytest

from kompass.algorithms.path_file import PathFileError, load_path
from tests.support.path_file import save_path

POSES = [(0.0, 0.0, 0.0), (1.0, 0.5, 1.2), (1.0, 2.0, -3.0)]


def test_a_path_is_read_as_it_was_saved(tmp_path: Path) -> None:
    saved = load_path(save_path(tmp_path / "loop.json", POSES))
    assert saved.frame == "map"
    assert saved.poses == pytest.approx(np.array(POSES))


def test_what_a_pose_may_leave_out_is_left_out(tmp_path: Path) -> None:
    poses = [{"pose": {"position": {"x": 1, "y": 2}}}]
    file = tmp_path / "short.json"
    file.write_text(json.dumps({"poses": poses}), encoding="utf-8")
    saved = load_path(file)
    assert saved.frame == ""
    assert saved.poses == pytest.approx(np.array([[1.0, 2.0, 0.0]]))


@pytest.mark.parametrize(
    ("fields", "told"),
    [
        ({"poses": None}, "poses: null; give a list"),
        ({"poses": [1]}, r"poses\[0\]: 1; give an object"),
        ({"poses": [{}]}, r"poses\[0\]\.pose\.position\.x: null; give a finite number"),
        (
            {"poses": [{"pose": {"position": {"x": "1", "y": 2}}}]},
            r'poses\[0\]\.pose\.position\.x: "1"; give a finite number',
        ),
        ({"poses": [{"pose": {"position": {"x": 1, "y": float("nan")}}}]}, r"position\.y: NaN"),
        ({"header": {"frame_id": 3}}, "header.frame_id: 3; give the name of a frame"),
        ({"header": []}, r"header: \[\]; give an object"),
    ],
)
def test_a_field_that_cannot_be_used_is_named(
    tmp_path: Path, fields: dict[str, object], told: str
) -> None:
    file = save_path(tmp_path / "bad.json", POSES, changed=fields)
    with pytest.raises(PathFileError, match=told):
        load_path(file)


@pytest.mark.parametrize("digits", [309, 5000])  # more than a float, and than an int is read of
def test_a_number_of_too_many_digits_is_named(tmp_path: Path, digits: int) -> None:
    file = tmp_path / "long.json"
    file.write_text(
        f'{{"poses": [{{"pose": {{"position": {{"x": 1{"0" * digits}, "y": 2}}}}}}]}}',
        encoding="utf-8",
    )
    with pytest.raises(PathFileError, match=r"position\.x: Infinity; give a finite number"):
        load_path(file)


def test_what_is_no_file_of_a_path_is_refused(tmp_path: Path) -> None:
    with pytest.raises(PathFileError, match="does not exist"):
        load_path(tmp_path / "none.json")
    with pytest.raises(PathFileError, match=r"is no plain file|cannot be read"):
        load_path(tmp_path)
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    with pytest.raises(PathFileError, match="is no plain file"):
        load_path(pipe)
    text = tmp_path / "text.json"
    text.write_text("<path/>", encoding="utf-8")
    with pytest.raises(PathFileError, match="is no JSON"):
        load_path(text)
    text.write_text("[" * 100_000, encoding="utf-8")
    with pytest.raises(PathFileError, match="is no JSON"):
        load_path(text)
