"""Whether an audit log is whole: every line names the digest of the line before."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from kompass_console.audit.files import log_files, read_end
from kompass_console.audit.line import BEGINNING, ChainLink, decode, digest


@dataclass
class Verdict:
    """What was found.

    Attributes
    ----------
    lines
        Whole lines that were looked at.
    first, last
        Number of the first line that is there; place of the last.
    broken
        Where the chain breaks first, and how; empty when it does not.
    notes
        What is no break of the chain, and should be known.
    """

    lines: int = 0
    first: int = 0
    last: ChainLink | None = None
    broken: str = ""
    notes: list[str] = field(default_factory=list)


def verify(path: Path, known: tuple[int, str] | None = None) -> Verdict:
    """Check a folder with an audit log, or one file of it or of an export.

    Parameters
    ----------
    known
        Number and digest of a line, as noted elsewhere: it must be among those that are there.

    Raises
    ------
    OSError
        When it cannot be read.
    """
    verdict = Verdict()
    # Before the lines: whatever is written meanwhile only makes the log longer.
    end = read_end(path) if path.is_dir() else None
    expected = {} if end is None else {end.seq: end.digest}
    if known is not None:
        expected[known[0]] = known[1]
    files = log_files(path) if path.is_dir() else [path]
    _walk(_lines(files), verdict, expected)
    seq = 0 if verdict.last is None else verdict.last.seq
    if verdict.broken:
        return verdict
    if known is not None and not verdict.first <= known[0] <= seq:
        verdict.broken = f"line {known[0]} is not there"
        return verdict
    if verdict.first > 1:
        verdict.notes.append(
            f"it begins with line {verdict.first}: older ones went to make room, or were removed"
        )
    if not path.is_dir():
        verdict.notes.append("of one file it cannot be known whether lines are missing at its end")
        return verdict
    if end is None:
        if verdict.lines:
            verdict.notes.append("end.json is missing: whether the end was cut off is not known")
    elif end.seq > seq:
        verdict.broken = f"lines {seq + 1} to {end.seq} are gone from its end"
    return verdict


def _walk(
    lines: Iterable[tuple[str, bytes]], verdict: Verdict, expected: Mapping[int, str]
) -> None:
    """Follow the chain to its first broken link; `expected` are digests by number of line."""
    before, torn = "", b""
    where = ""
    for where, line in lines:
        said = decode(line)
        if said is None:
            if torn:
                verdict.broken = f"{where} is no line of an audit log, nor is the one before"
                return
            torn = line
            continue
        if torn and said.get("torn") != digest(torn):
            verdict.broken = f"the line before {where} is no line of an audit log"
            return
        last = verdict.last
        if last is None:
            verdict.first = said["seq"]
            if said["seq"] == 1 and said["prev"] != BEGINNING:
                verdict.broken = f"{where} is the first line, and names one before it"
                return
        elif said["seq"] != last.seq + 1:
            verdict.broken = f"{where} has number {said['seq']} after {last.seq}"
            return
        elif said["prev"] != before:
            verdict.broken = (
                f"{where} (line {said['seq']}) does not follow from the line before: "
                "one of the two was changed"
            )
            return
        before, torn = digest(line), b""
        verdict.lines += 1
        verdict.last = ChainLink(said["seq"], said["prev"], before)
        if expected.get(said["seq"], before) != before:
            verdict.broken = f"{where} (line {said['seq']}) is not as it was noted: it was changed"
            return
    if torn:
        verdict.notes.append(f"{where} was never ended; the next line that is written says so")


def _lines(files: Iterable[Path]) -> Iterator[tuple[str, bytes]]:
    """Where each line is, and the line."""
    for file in files:
        lines = file.read_bytes().split(b"\n")
        if not lines[-1]:
            lines.pop()
        for number, line in enumerate(lines, 1):
            yield f"{file.name}:{number}", line
