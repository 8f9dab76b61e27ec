"""What is shipped is pinned, listed with its licence, and told in the wheel."""

from __future__ import annotations

import base64
import hashlib
import importlib.util
import json
import zipfile
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]


@pytest.fixture
def dependencies() -> Any:
    spec = importlib.util.spec_from_file_location(
        "dependencies", ROOT / "cmake" / "dependencies.py"
    )
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_lock_and_licences_fit_what_is_needed(dependencies: Any) -> None:
    assert dependencies.faults() == []


def test_what_is_needed_and_not_pinned_or_listed_is_told(
    dependencies: Any, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    lock, licences = tmp_path / "requirements.lock", tmp_path / "licences.md"
    text = (ROOT / "requirements.lock").read_text()
    lock.write_text(
        text.replace("viser==1.1.1", "viser==1.1.0").replace("\nfastapi==", "\nother==")
    )
    text = (ROOT / "docs" / "licences.md").read_text()
    licences.write_text(text.replace("| react-dom |", "| gone |"))
    monkeypatch.setattr(dependencies, "LOCK", lock)
    monkeypatch.setattr(dependencies, "LICENCES", licences)
    assert dependencies.faults() == [
        "requirements.lock does not pin fastapi",
        "requirements.lock pins viser 1.1.0, not ==1.1.1",
        "docs/licences.md does not list other",
        "docs/licences.md does not list react-dom",
        "docs/licences.md lists fastapi, which is gone",
        "docs/licences.md lists gone, which is gone",
    ]


def test_a_wheel_carries_its_bill_and_its_record_says_so(dependencies: Any, tmp_path: Path) -> None:
    wheel = tmp_path / "kompass_console-0.1.0-py3-none-any.whl"
    info = "kompass_console-0.1.0.dist-info"
    with zipfile.ZipFile(wheel, "w") as made:
        made.writestr("kompass_console/__init__.py", "")
        made.writestr(f"{info}/RECORD", f"kompass_console/__init__.py,,\n{info}/RECORD,,\n")
    dependencies.put_into(wheel)
    with zipfile.ZipFile(wheel) as made:
        text = made.read(f"{info}/sboms/kompass-console.cdx.json")
        record = made.read(f"{info}/RECORD").decode().splitlines()
        assert made.testzip() is None
    [line] = [each for each in record if "sboms" in each]
    sha = base64.urlsafe_b64encode(hashlib.sha256(text).digest()).rstrip(b"=").decode()
    assert line.endswith(f",sha256={sha},{len(text)}")
    bill = json.loads(text)
    assert bill["bomFormat"] == "CycloneDX"
    named = {part["purl"].partition("@")[0]: part for part in bill["components"]}
    for name in ("pkg:pypi/viser", "pkg:pypi/ros-fastrtps", "pkg:npm/react"):
        assert named[name]["hashes"]
    assert "pkg:npm/vitest" not in named, "a tool of ours is not shipped"


def test_a_database_that_cannot_be_asked_is_told_and_known_holes_are_named(
    dependencies: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    silent = ["sh", "-c", "echo 'no route to the database' >&2; exit 1"]
    assert dependencies.ask("Python", silent, tmp_path) is None
    assert capsys.readouterr().out == "Python: not looked up: no route to the database\n"
    told: dict[str, Any] = {
        "dependencies": [
            {"name": "good", "version": "1", "vulns": []},
            {
                "name": "bad",
                "version": "2",
                "vulns": [{"id": "CVE-2026-1", "fix_versions": ["2.1"]}],
            },
        ]
    }
    assert dependencies.known_in_python(told) == ["bad 2: CVE-2026-1, mended in ['2.1']"]
    told = {"vulnerabilities": {"left": {"range": "<1.3", "severity": "high"}}}
    assert dependencies.known_in_page(told) == ["left <1.3: high"]
