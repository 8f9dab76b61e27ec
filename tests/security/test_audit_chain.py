"""The audit log is a chain: what is changed, taken out or cut off in it is found."""

from __future__ import annotations

import fcntl
import json
import os
import signal
import stat
import subprocess
import sys
import threading
import time
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from typer.testing import CliRunner

from kompass_console.audit.files import log_files
from kompass_console.audit.line import AuditEntry, decode, encode
from kompass_console.audit.log import AuditLog
from kompass_console.audit.read import lines_after, newest
from kompass_console.audit.verify import verify
from kompass_console.audit_cli import app
from tests.support.processes import wait_until


def entry(what: str, **details: Any) -> AuditEntry:
    return AuditEntry(time.time(), "ava", "operator", "1234abcd", "10.0.0.7", what, "done", details)


def wrote(folder: Path, *deeds: str, **options: Any) -> None:
    """A console's whole life: it writes these lines and ends."""
    log = AuditLog(folder, **options)
    for deed in deeds:
        log.append(entry(deed))
    log.close()


def deeds(folder: Path) -> list[str]:
    return [line["what"] for line in lines_after(folder, 0)]


def longer_than(folder: Path, count: int) -> bool:
    return len(deeds(folder)) > count


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A log of a hundred lines in several files, by several consoles one after the other."""
    folder = tmp_path / "ava" / "audit"
    for life in range(5):
        wrote(folder, *(f"deed {20 * life + number}" for number in range(20)), largest_file=4_000)
    return folder


def test_the_chain_goes_on_over_restarts_and_from_file_to_file(folder: Path) -> None:
    assert deeds(folder) == [f"deed {number}" for number in range(100)]
    assert len(log_files(folder)) > 2
    verdict = verify(folder)
    assert (verdict.lines, verdict.first, verdict.broken, verdict.notes) == (100, 1, "", [])


@settings(max_examples=60, deadline=None)
@given(data=st.data())
def test_no_byte_is_changed_unnoticed(
    data: st.DataObject, tmp_path_factory: pytest.TempPathFactory
) -> None:
    folder = tmp_path_factory.mktemp("log")
    wrote(folder, *(f"deed {number}" for number in range(8)))
    [file] = log_files(folder)
    content = bytearray(file.read_bytes())
    # The last line end says nothing.
    place = data.draw(st.integers(0, len(content) - 2))
    content[place] ^= data.draw(st.sampled_from([1, 2, 4, 8, 16]))
    file.write_bytes(content)
    assert verify(folder).broken


@pytest.mark.parametrize("missing", [1, 40, 98])
def test_a_line_that_is_taken_out_is_missed(folder: Path, missing: int) -> None:
    for file in log_files(folder):
        lines = file.read_bytes().splitlines(keepends=True)
        file.write_bytes(b"".join(line for line in lines if f'"seq":{missing},' not in str(line)))
    verdict = verify(folder)
    if missing == 1:
        assert verdict.notes == [
            "it begins with line 2: older ones went to make room, or were removed"
        ]
    else:
        assert f"has number {missing + 1} after {missing - 1}" in verdict.broken


def test_a_cut_end_is_missed_also_after_it_was_written_on(folder: Path) -> None:
    file = log_files(folder)[-1]
    lines = file.read_bytes().splitlines(keepends=True)
    file.write_bytes(b"".join(lines[:-3]))
    assert verify(folder).broken == "lines 98 to 100 are gone from its end"
    log = AuditLog(folder)
    log.append(entry("later"))
    wait_until(lambda: deeds(folder)[-1] == "later", 5, "the next line")
    assert "lines 98 to 100 are gone" in log.problem
    log.close()
    assert "has number 101 after 97" in verify(folder).broken
    assert "lines 98 to 100 are gone" in lines_after(folder, 0)[-2]["outcome"]


def test_an_end_that_was_cut_off_with_all_that_knows_of_it_is_found_by_a_note_kept_elsewhere(
    folder: Path,
) -> None:
    noted = verify(folder).last
    assert noted is not None
    file = log_files(folder)[-1]
    file.write_bytes(b"".join(file.read_bytes().splitlines(keepends=True)[:-3]))
    (folder / "end.json").unlink()
    verdict = verify(folder)
    assert not verdict.broken
    assert "whether the end was cut off is not known" in verdict.notes[0]
    assert verify(folder, (noted.seq, noted.digest)).broken == "line 100 is not there"


def test_a_line_torn_by_kill_is_healed_and_said(folder: Path) -> None:
    file = log_files(folder)[-1]
    whole = encode(entry("never ended"), 101, verify(folder).last.digest)  # type: ignore[union-attr]
    with file.open("ab") as stream:
        stream.write(whole[:57])
    assert "was never ended" in verify(folder).notes[0]
    wrote(folder, "later")
    healed, later = lines_after(folder, 100)
    assert healed["outcome"] == "healed: the 57 bytes before are a line that was torn"
    assert later["what"] == "later"
    assert (verify(folder).broken, verify(folder).lines) == ("", 102)


def test_a_whole_line_that_only_lacks_its_end_counts(folder: Path) -> None:
    file = log_files(folder)[-1]
    file.write_bytes(file.read_bytes().removesuffix(b"\n"))
    wrote(folder, "later")
    assert deeds(folder)[-2:] == ["deed 99", "later"]
    assert verify(folder).broken == ""


def test_nothing_that_was_on_disk_is_lost_when_the_console_is_killed(tmp_path: Path) -> None:
    folder = tmp_path / "audit"
    for life in range(4):
        begun = len(deeds(folder))
        with subprocess.Popen([sys.executable, "-m", "tests.security.audit_writer", folder]) as it:
            wait_until(partial(longer_than, folder, begun + 50), 10, f"lines of life {life}")
            it.send_signal(signal.SIGKILL)
    verdict = verify(folder)
    assert verdict.broken == ""
    assert verdict.lines > 200


def test_two_consoles_of_one_robot_write_one_chain(tmp_path: Path) -> None:
    folder = tmp_path / "audit"
    logs = [AuditLog(folder, largest_file=3_000) for _ in range(3)]

    def write(log: AuditLog, who: int) -> None:
        for number in range(100):
            log.append(entry(f"{who} {number}"))
            if number % 10 == 0:
                time.sleep(0.001)

    threads = [threading.Thread(target=write, args=(log, who)) for who, log in enumerate(logs)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    wait_until(lambda: len(deeds(folder)) == 300, 10, "all lines")
    for log in logs:
        log.close()
    assert verify(folder).broken == ""
    for who in range(3):
        own = [deed for deed in deeds(folder) if deed.startswith(f"{who} ")]
        assert own == [f"{who} {number}" for number in range(100)]


def test_it_is_bounded_and_the_oldest_goes_first(tmp_path: Path) -> None:
    folder = tmp_path / "audit"
    log = AuditLog(folder, largest_file=2_000, most_files=4, waiting=100_000)
    for number in range(1000):
        log.append(entry(f"deed {number}"))
    log.close()
    assert len(log_files(folder)) <= 4
    assert deeds(folder)[-1] == "deed 999"
    verdict = verify(folder)
    assert verdict.broken == ""
    assert verdict.notes == [
        f"it begins with line {verdict.first}: older ones went to make room, or were removed"
    ]


def test_only_its_owner_reads_it(folder: Path) -> None:
    assert stat.S_IMODE(folder.stat().st_mode) == 0o700
    assert stat.S_IMODE(folder.parent.stat().st_mode) == 0o700
    for file in folder.iterdir():
        assert stat.S_IMODE(file.stat().st_mode) == 0o600, file


def test_a_line_steers_no_terminal_and_is_of_bounded_length() -> None:
    bad = "\x1b[2J\n\x9b31m\u202e" * 1000
    line = encode(AuditEntry(0.0, bad, "none", "", bad, bad, bad, {"reason": bad}), 1, "0" * 64)
    assert line.isascii()
    assert b"\x1b" not in line
    assert b"\n" not in line
    assert len(line) < 20_000
    assert decode(line)


def test_older_lines_are_found_page_by_page_and_by_what_they_say(folder: Path) -> None:
    seen: list[int] = []
    more, before = True, 0
    while more:
        lines, more = newest(folder, before=before, count=30)
        seen += [line["seq"] for line in lines]
        before = seen[-1]
    assert seen == list(range(100, 0, -1))
    found, more = newest(folder, text="DEED 42")
    assert [line["seq"] for line in found] == [43]
    assert not more
    digest = found[0]["prev"]
    assert newest(folder, text=digest[:6]) == ([], False)
    wrote(folder, 'said "Grüße" \\ 測試')
    for text in ('said "gr', "üße", "\\ 測"):
        assert newest(folder, text=text)[0][0]["seq"] == 101


def test_the_command_line_shows_and_verifies(folder: Path) -> None:
    root = ["--data-dir", str(folder.parent.parent), "--name", "ava"]
    shown = CliRunner().invoke(app, ["--count", "2", *root])
    assert shown.exit_code == 0
    assert [line.split(": ")[1] for line in shown.output.splitlines()] == ["deed 98", "deed 99"]
    assert "ava (operator 1234abcd) from 10.0.0.7" in shown.output
    raw = CliRunner().invoke(app, ["--json", "--count", "1", *root]).output
    assert json.loads(raw)["what"] == "deed 99"
    whole = CliRunner().invoke(app, ["verify", *root])
    assert whole.exit_code == 0
    noted = whole.output.split("the last is ")[1].strip()
    assert CliRunner().invoke(app, ["verify", *root, "--known", noted]).exit_code == 0
    file = log_files(folder)[0]
    file.write_bytes(file.read_bytes().replace(b"deed 3", b"deed 8", 1))
    broken = CliRunner().invoke(app, ["verify", *root])
    assert "is broken" in str(broken.exception)
    assert f"{file.name}:5 (line 5) does not follow" in str(broken.exception)


def test_what_the_log_is_told_costs_the_teller_nothing(tmp_path: Path) -> None:
    """Its lock is held by another process, so nothing can be written; told it is all the same."""
    folder = tmp_path / "audit"
    wrote(folder, "before")
    held = os.open(folder / "audit.lock", os.O_RDWR)
    fcntl.flock(held, fcntl.LOCK_EX)
    log = AuditLog(folder)
    log.append(entry("meanwhile"))
    wait_until(lambda: "does not answer" in log.problem, 5, "that people are told")
    assert deeds(folder) == ["before"]
    os.close(held)
    wait_until(lambda: deeds(folder) == ["before", "meanwhile"], 5, "the line")
    wait_until(lambda: log.problem == "", 5, "that all is well")
    log.close()
