"""A topic's name is judged where it is written, and not when its process comes up."""

from typing import Any

import pytest

from kompass.ros import Topic


@pytest.mark.parametrize("name", ["/a b", "/a//b", "/é", "/1st", "a/", "x" * 300, " ", None, 5])
def test_a_name_that_ros_does_not_know_is_refused_with_what_to_give(name: Any) -> None:
    with pytest.raises((ValueError, TypeError), match=r"Topic name = .*(give|is empty)"):
        Topic(name=name, msg_type="Bool")


@pytest.mark.parametrize("name", ["scan", "/scan", " /front/scan ", "~/mine", "x" * 240])
def test_a_name_that_ros_knows_is_taken(name: str) -> None:
    assert Topic(name=name, msg_type="Bool").name == name.strip().removeprefix("/")
