"""Arrows run one way: a package imports only what lies below it, and no modules form a circle."""

import ast
import functools
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]

# The parts of each package in layers, the ground first. A part may import the layers before its
# own, and nothing of its own layer but itself. A new part gets a place here.
LAYERS: dict[str, tuple[tuple[str, ...], ...]] = {
    "kompass": (
        (
            "algorithms",
            "bus",
            "half_characters",
            "invalid",
            "named_arguments",
            "porting",
            "printable",
            "rules",
            "settings",
            "share",
            "signing",
            "supervisor",
            "json_once",
            "message_types",
            "yaml_lines",
        ),
        ("channel", "field_types"),
        ("expressions", "places", "robot", "rulebook"),
        ("missions", "zones"),
        ("timeline",),
        ("rclpy_ext",),
        ("virtual",),
        ("backtest",),
        ("store",),
        ("access",),
        ("components",),
        ("config", "control", "recipe"),
        ("monitor",),
        ("recorder",),
        ("simulation",),
        ("launch",),
        ("drills",),
        ("bench",),
        ("actions", "event", "launcher"),
        ("events", "ros"),
        ("compat",),
    ),
    "kompass.rules": (("schema",), ("checks", "engine")),
    "kompass.rulebook": (
        ("schema",),
        ("sources", "views"),
        ("diff", "lint", "outlook", "permissions"),
        ("guard", "merge"),
    ),
    "kompass.components": (
        ("base", "topics_keys"),
        ("controller", "drive", "mapping", "motion", "planner"),
    ),
    "kompass_console": (
        ("control", "version"),
        ("audit", "cli_error", "private_file", "recordings", "schema"),
        ("accounts", "domain", "drills", "driving", "webhooks"),
        ("settings",),
        ("link", "scene"),
        ("web",),
        ("api",),
        ("openapi", "server"),
        ("audit_cli", "rules_cli", "stack", "users_cli"),
        ("bench_cli", "drill_cli"),
        ("cli",),
        ("__main__",),
    ),
}


def module_name(source: Path) -> str:
    parts = source.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


MODULES = {
    module_name(source): source
    for package in ("kompass", "kompass_console")
    for source in (ROOT / package).rglob("*.py")
}


def imported(name: str) -> Iterator[str]:
    """Walk the modules of ours that a module imports, in functions and for types too."""
    for node in ast.walk(ast.parse(MODULES[name].read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{name}: write out the name of the package in imports"
            whole = [f"{node.module}.{alias.name}" for alias in node.names]
            found = [each if each in MODULES else node.module or "" for each in whole]
        else:
            continue
        yield from (each for each in found if each in MODULES)


@functools.cache
def imports() -> dict[str, set[str]]:
    """What each module of ours imports of ours.

    Found out by who asks: every worker collects this file, and one runs it.
    """
    return {name: set(imported(name)) for name in MODULES}


def part_of(name: str, package: str) -> str | None:
    """Return the part of a package that a module belongs to; None outside, and for its root."""
    inner = name.removeprefix(f"{package}.")
    return None if inner == name else inner.partition(".")[0]


@pytest.mark.parametrize("package", LAYERS)
def test_a_part_of_a_package_imports_only_what_lies_below_it(package: str) -> None:
    layer_of = {part: n for n, layer in enumerate(LAYERS[package]) for part in layer}
    parts = {part for name in MODULES if (part := part_of(name, package))}
    assert parts == set(layer_of), "each part has a place in LAYERS"
    upward = [
        f"{name} imports {other}"
        for name, others in sorted(imports().items())
        for other in sorted(others)
        if (mine := part_of(name, package))
        and (theirs := part_of(other, package))
        and mine != theirs
        and layer_of[theirs] >= layer_of[mine]
    ]
    assert upward == []


def test_the_stack_knows_nothing_of_the_console() -> None:
    aware = [
        f"{name} imports {other}"
        for name, others in imports().items()
        for other in others
        if part_of(name, "kompass") and part_of(other, "kompass_console")
    ]
    assert aware == []


def test_what_every_import_runs_first_imports_nothing_else_of_ours() -> None:
    first = {"kompass.porting", "kompass.rclpy_ext.middleware"}
    assert imports()["kompass"] == first
    assert all(imports()[name] == set() for name in first)
    assert imports()["kompass_console"] == set()


def test_no_modules_import_each_other_in_a_circle() -> None:
    try:
        TopologicalSorter(imports()).prepare()
    except CycleError as error:
        pytest.fail(" imports ".join(reversed(error.args[1])))
