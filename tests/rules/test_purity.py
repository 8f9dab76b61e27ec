"""The engine is pure: no ROS, no clock, no threads, no I/O, and nothing else of ours."""

import ast
from pathlib import Path

import kompass.rules

ALLOWED = {
    "bisect",
    "collections",
    "dataclasses",
    "difflib",
    "enum",
    "hashlib",
    "heapq",
    "json",
    "math",
    "numpy",
    "operator",
    "pydantic",
    "pydantic_core",
    "re",
    "typing",
    "weakref",
}
SOURCES = sorted(Path(kompass.rules.__file__).parent.rglob("*.py"))


def imports(source: Path) -> set[str]:
    found: set[str] = set()
    for node in ast.walk(ast.parse(source.read_text())):
        if isinstance(node, ast.Import):
            found.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            found.add(node.module or "")
    return found


def test_the_engine_imports_nothing_that_could_make_it_impure() -> None:
    for source in SOURCES:
        foreign = {name for name in imports(source) if not name.startswith("kompass.rules")}
        assert {name.split(".")[0] for name in foreign} <= ALLOWED, source.name


def test_every_name_of_the_package_is_there() -> None:
    assert all(hasattr(kompass.rules, name) for name in kompass.rules.__all__)
