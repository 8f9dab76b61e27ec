"""The hook of mkdocs: adds the generated pages, and what lies elsewhere in the repository."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Any

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT))

from docs.hooks.pages import generated_pages  # noqa: E402 - mkdocs loads this file by its path


def on_files(files: Files, *, config: MkDocsConfig) -> Files:
    """Add the generated pages to those of the folder."""
    for path, text in generated_pages(ROOT).items():
        files.append(File.generated(config, path, content=text))
    return files


def on_page_markdown(markdown: str, **_: Any) -> str:
    """Put drawings into the page, so that they have its colours; leave out notes to the tests."""
    markdown = re.sub(r"^!\[[^]]*\]\((assets/\w+\.svg)\)$", _drawing, markdown, flags=re.MULTILINE)
    return re.sub(r"^[ ]*<!-- docs-test: .*? -->\n", "", markdown, flags=re.MULTILINE)


def _drawing(picture: re.Match[str]) -> str:
    text = (ROOT / "docs" / picture[1]).read_text(encoding="utf-8")
    return "\n".join(line for line in text.splitlines() if line.strip())
