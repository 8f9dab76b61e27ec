"""``scripts/setup`` makes anew what a build input changed, and only that."""

import importlib.util
import shutil
from pathlib import Path
from types import ModuleType

import pytest

CHECKOUT = Path(__file__).resolve().parents[1]


@pytest.fixture
def install(tmp_path: Path) -> ModuleType:
    """The installer, on a copy of the checkout that may be edited."""
    spec = importlib.util.spec_from_file_location("install", CHECKOUT / "cmake" / "install.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    for folder in ("cmake", "kompass/interfaces", "web"):
        shutil.copytree(
            CHECKOUT / folder,
            tmp_path / folder,
            ignore=shutil.ignore_patterns("node_modules", "__pycache__"),
        )
    for file in ("CMakeLists.txt", "README.md", "pyproject.toml"):
        shutil.copy(CHECKOUT / file, tmp_path)
    module.__dict__["ROOT"] = tmp_path
    return module


@pytest.mark.parametrize(
    ("file", "old", "new", "made_again"),
    [
        ("README.md", "", "# more", set()),
        ("kompass/__init__.py", "", "# more", set()),
        ("kompass/new_module.py", "", "A = 1", set()),
        ("kompass/params/new.yaml", "", "a: 1", set()),
        ("recipes/01_point_navigation.py", "", "# more", set()),
        ("cmake/install.py", "", "# more", set()),
        ("pyproject.toml", "line-length = 100", "line-length = 99", set()),
        ("web/src/format.test.ts", "", "// more", set()),
        ("web/src/api/schema.ts", "", "// generated", set()),
        ("web/src/main.tsx", "", "// more", {"page"}),
        ("web/package-lock.json", "", " ", {"page"}),
        ("kompass/interfaces/kompass_interfaces/msg/New.msg", "", "float64 x", {"interfaces"}),
        ("cmake/interfaces.cmake", "", "# more", {"interfaces"}),
        ("pyproject.toml", '"rich>=13"', '"rich>=14"', {"run", "interfaces"}),
        ("pyproject.toml", '"pytest>=8"', '"pytest>=9"', {"test"}),
        ("pyproject.toml", '"scikit-build-core>=', '"scikit-build-core>', {"build", "interfaces"}),
    ],
)
def test_only_what_an_edit_concerns_is_made_again(
    install: ModuleType, tmp_path: Path, file: str, old: str, new: str, made_again: set[str]
) -> None:
    before = install.stamps(["page", "test"])
    edited = tmp_path / file
    edited.parent.mkdir(parents=True, exist_ok=True)
    text = edited.read_text() if edited.exists() else ""
    assert old in text
    edited.write_text(text.replace(old, new) if old else text + new)
    after = install.stamps(["page", "test"])
    assert {part for part in after if after[part] != before[part]} == made_again


def test_what_there_is_not_is_answered_with_what_there_is(install: ModuleType) -> None:
    with pytest.raises(SystemExit, match=r"'--help'; there are: page .*, test"):
        install.stamps(["--help"])
