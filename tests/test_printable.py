"""Texts of others never steer the terminal that they are printed on."""

import io
import logging
import os
import subprocess
import sys

import pytest

from kompass.printable import LONGEST, PrintableFormatter, printable

BAD = "\x1b[2J\x1b]0;owned\x07\r\nFAKE 12:00:00 all is well\x9b31m\u202e"
CONTROLS = [chr(code) for code in [*range(32), 127, *range(128, 160), 0x202E, 0x2028]]


@pytest.mark.parametrize("control", CONTROLS, ids=[f"{ord(c):x}" for c in CONTROLS])
def test_no_control_character_is_let_through(control: str) -> None:
    assert printable(f"a{control}b").isprintable()


def test_letters_of_all_scripts_stay_and_lengths_are_bounded() -> None:
    assert printable("Größe 測試 ✓ 0 °C") == "Größe 測試 ✓ 0 °C"
    assert len(printable("x" * 10_000)) == LONGEST


def test_a_log_record_is_one_line_and_only_its_traceback_has_more() -> None:
    stream = io.StringIO()
    handler = logging.StreamHandler(stream)
    handler.setFormatter(PrintableFormatter("%(message)s"))
    logger = logging.Logger("test")
    logger.addHandler(handler)
    logger.warning("rule says: %s", BAD)
    assert stream.getvalue().count("\n") == 1
    assert "\x1b" not in stream.getvalue()
    assert r"\r\nFAKE" in stream.getvalue()
    try:
        raise ValueError(BAD)
    except ValueError:
        logger.exception("failed")
    assert stream.getvalue().count("\n") > 3
    assert stream.getvalue().replace("\n", "").isprintable()


@pytest.mark.ros
def test_what_a_rule_logs_reaches_the_terminal_of_ros_without_its_control_characters() -> None:
    code = (
        "from rclpy.logging import get_logger\n"
        "from kompass.rclpy_ext.log import write_log\n"
        f"write_log(get_logger('monitor'), 'error', {BAD!r})\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "RCUTILS_COLORIZED_OUTPUT": "0"},
    )
    [line] = done.stderr.splitlines()
    assert line.isprintable()
    assert r"\x1b[2J" in line
