"""What the documentation shows: its fenced blocks, links, and the paths that it names."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
PAGES = sorted(
    [
        *(ROOT / "docs").glob("*.md"),
        *(ROOT / name for name in ("README.md", "CONTRIBUTING.md", "recipes/README.md")),
    ]
)
_FENCE = re.compile(r"^(?P<indent> *)(?P<ticks>`{3,})(?P<language>[^\n`]*)$")
_NOTE = re.compile(r"<!-- docs-test: (?P<note>.*?) -->")


@dataclass(frozen=True)
class Block:
    """One fenced block.

    Attributes
    ----------
    note
        What the comment ``<!-- docs-test: … -->`` above it says; for the tests only.
    """

    page: Path
    line: int
    language: str
    note: str
    text: str

    @property
    def where(self) -> str:
        """Page and line, as an editor takes them."""
        return f"{self.page.relative_to(ROOT)}:{self.line}"

    def option(self, name: str) -> str | None:
        """The value of ``name=value`` in the note."""
        found = re.search(rf"(?:^|\s){name}=(\S+)", self.note)
        return found[1] if found else None


def blocks_of(page: Path) -> Iterator[Block]:
    """Walk the fenced blocks of a page."""
    lines = page.read_text(encoding="utf-8").splitlines()
    note, index = "", 0
    while index < len(lines):
        line = lines[index]
        fence = _FENCE.match(line)
        if fence is None:
            said = _NOTE.search(line)
            note = said["note"] if said else ("" if line.strip() else note)
            index += 1
            continue
        begin, index = index + 1, index + 1
        while lines[index].strip() != fence["ticks"]:
            index += 1
        text = textwrap.dedent("\n".join(lines[begin:index])) + "\n"
        yield Block(page, begin, fence["language"].strip(), note, text)
        note, index = "", index + 1


def all_blocks(*languages: str) -> list[Block]:
    """The blocks of all pages that are in one of these languages; of any, if none is given."""
    found = [block for page in PAGES for block in blocks_of(page)]
    return [block for block in found if not languages or block.language in languages]


def prose_of(page: Path) -> str:
    """A page without its fenced blocks."""
    kept, inside = [], False
    for line in page.read_text(encoding="utf-8").splitlines():
        if _FENCE.match(line):
            inside = not inside
        elif not inside:
            kept.append(line)
    return "\n".join(kept)


def links_of(page: Path) -> list[str]:
    """Targets of the links and pictures of a page that lead elsewhere in the repository."""
    targets = re.findall(r"\]\(([^)\s]+)\)", prose_of(page))
    return [one for one in targets if not re.match(r"[a-z]+:|#", one)]


_PATH = re.compile(
    r"(?<![\w./~<-])((?:kompass|kompass_console|web|tests|docs|scripts|recipes|benchmarks|cmake)"
    r"/[\w./*-]*[\w/*])"
)


def paths_of(page: Path) -> list[str]:
    """Paths of the repository that a page names as code, in its prose and in `text` blocks."""
    spans = re.findall(r"`([^`\n]+)`", prose_of(page))
    spans += [b.text for b in blocks_of(page) if b.language in ("text", "sh")]
    return [path for span in spans for path in _PATH.findall(span)]
