"""The supervisor stands alone: it imports the standard library, and nothing else of ours."""

import ast
import sys
from pathlib import Path

import kompass.supervisor

FOLDER = Path(kompass.supervisor.__file__).parent


def imported(source: Path) -> set[str]:
    found: set[str] = set()
    for node in ast.walk(ast.parse(source.read_text())):
        if isinstance(node, ast.Import):
            found.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{source.name} imports relatively"
            found.add(node.module or "")
    return found


def test_it_imports_nothing_else_of_ours_and_no_other_package() -> None:
    sources = sorted(FOLDER.rglob("*.py"))
    assert len(sources) > 5
    for source in sources:
        for name in imported(source):
            own = name == "kompass.supervisor" or name.startswith("kompass.supervisor.")
            assert own or name.split(".")[0] in sys.stdlib_module_names, f"{source.name}: {name}"
