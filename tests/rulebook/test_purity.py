"""What is said of tables is computed from them alone: no ROS, no clock, no threads, no I/O."""

from pathlib import Path

import kompass.rulebook
from tests.rules.test_purity import ALLOWED, imports

OURS = ("kompass.rules", "kompass.rulebook")
SOURCES = sorted(Path(kompass.rulebook.__file__).parent.rglob("*.py"))


def test_nothing_is_imported_that_could_make_it_impure() -> None:
    assert len(SOURCES) > 20
    for source in SOURCES:
        foreign = {name for name in imports(source) if not name.startswith(OURS)}
        allowed = ALLOWED | {"statistics"}
        assert {name.split(".")[0] for name in foreign} <= allowed, source.name
