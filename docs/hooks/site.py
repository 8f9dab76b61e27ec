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
    """Leave out what speaks to the tests only."""
    return re.sub(r"^[ ]*<!-- docs-test: .*? -->\n", "", markdown, flags=re.MULTILINE)


def on_page_content(html: str, **_: Any) -> str:
    """Put drawings into the page itself, so that they have the colours of its theme."""
    return re.sub(r'<img [^>]*src="(assets/\w+\.svg)"[^>]*>', _drawing, html)


def _drawing(picture: re.Match[str]) -> str:
    return (ROOT / "docs" / picture[1]).read_text(encoding="utf-8")
