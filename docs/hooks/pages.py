"""Which pages are generated, and from what."""

from __future__ import annotations

import re
from pathlib import Path

from docs.hooks.command_line import command_line_page
from docs.hooks.environment import environment_page
from docs.hooks.http_api import http_page
from docs.hooks.interfaces import interfaces_page
from docs.hooks.recipes import recipes_page
from docs.hooks.rule_schema import rule_schema_page
from docs.hooks.settings import settings_page

INDEX = """# Reference

These pages are generated from the code each time the documentation is built, so they are what this
release does.

| page | from |
|---|---|
| [Settings](settings.md) | the settings of each component: name, type, default, bounds, unit |
| [Rule schema](rule-schema.md) | every field of a rule, an event, a condition and an action |
| [Messages and services](interfaces.md) | the ROS 2 interfaces that the project adds |
| [HTTP and WebSocket](http.md) | what the page talks to, for scripts of your own |
| [Command line](command-line.md) | `kompass-console` and all its options |
| [Environment variables](environment.md) | what can be said without an option |
| [Recipes](recipes.md) | the recipes that come with the project, whole |
"""


def generated_pages(root: Path) -> dict[str, str]:
    """Markdown by path below the documentation's folder.

    Parameters
    ----------
    root
        Folder of the repository.
    """
    return {
        "reference/index.md": INDEX,
        "reference/settings.md": settings_page(),
        "reference/rule-schema.md": rule_schema_page(),
        "reference/interfaces.md": interfaces_page(root / "kompass" / "interfaces"),
        "reference/http.md": http_page(root / "web" / "openapi.json"),
        "reference/command-line.md": command_line_page(),
        "reference/environment.md": environment_page(),
        "reference/recipes.md": recipes_page(root / "recipes"),
        "contributing.md": _as_page(root / "CONTRIBUTING.md"),
        "changelog.md": _as_page(root / "CHANGELOG.md"),
    }


def page_names() -> frozenset[str]:
    """Paths of the generated pages, without making them."""
    made = ("settings", "rule-schema", "interfaces", "http", "command-line", "environment")
    listed = [f"reference/{name}.md" for name in (*made, "index", "recipes")]
    return frozenset([*listed, "contributing.md", "changelog.md"])


def _as_page(path: Path) -> str:
    """A file of the repository's root as a page: its links to the documentation lead on."""
    return re.sub(r"\]\(docs/", "](", path.read_text(encoding="utf-8"))
