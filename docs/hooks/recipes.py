"""The recipes that come with the project, whole, on one page."""

from __future__ import annotations

import re
from pathlib import Path


def recipes_page(folder: Path) -> str:
    """Their readme, then each of them.

    Parameters
    ----------
    folder
        Holds the recipes and their readme.
    """
    readme = (folder / "README.md").read_text(encoding="utf-8")
    readme = re.sub(r"\]\((\d\w+)\.py\)", r"](#\1)", readme)
    readme = readme.replace("README.md beside this file", "the table above")
    parts = [readme]
    for path in sorted(folder.glob("[0-9]*.py")):
        text = path.read_text(encoding="utf-8").strip()
        parts.append(f"## {path.stem} {{ #{path.stem} }}\n\n```python\n{text}\n```\n")
    return "\n".join(parts)
