"""What `docs/start.md` has a stranger type works, in its order, on the demo."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.docs.blocks import ROOT, blocks_of
from tests.support.patience import patient
from tests.support.stack import Stack

pytestmark = [pytest.mark.ros, pytest.mark.slow]
PAGE = ROOT / "docs" / "start.md"


@pytest.fixture
def demo() -> Iterator[Stack]:
    stack = Stack("demo", "--no-browser", "--port", "0")
    try:
        stack.wait_for_line("all components active", 20)
        yield stack
    finally:
        stack.close()


def test_the_first_rule_is_checked_tried_applied_and_confirmed(demo: Stack, tmp_path: Path) -> None:
    (rule,) = (block for block in blocks_of(PAGE) if block.language == "yaml")
    (tmp_path / "first.yaml").write_text(rule.text, encoding="utf-8")
    said = []
    for block in blocks_of(PAGE):
        if block.language == "sh" and "kompass-console rules" in block.text:
            done = subprocess.run(
                # There is no terminal here that could be asked.
                ["bash", "-e", "-c", block.text.replace("rules apply", "rules apply --yes")],
                text=True,
                capture_output=True,
                cwd=tmp_path,
                timeout=patient(60),
                env={
                    **os.environ,
                    "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}",
                    "ROS_DOMAIN_ID": str(demo.domain),
                    "COLUMNS": "200",
                },
            )
            assert not done.returncode, f"{block.where}: {done.stdout}{done.stderr}"
            said.append(done.stdout)
    applied, looked = said
    assert "messages over" in applied  # what it was tried on
    assert "revision 2 is in force" in applied
    assert "revision 2 is confirmed" in looked
    assert "min(scan.ranges) < 0.5" in looked  # why, or why not
