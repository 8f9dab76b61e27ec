"""A crash or a power cut at any moment leaves the old or the new table."""

from pathlib import Path

from benchmarks.store_crash import cut_everywhere, kill_at_random
from tests.support.properties import few_or_many


@few_or_many(15, few=4)
def test_killed_at_random_moments_it_opens_on_the_old_or_the_new_table(
    tmp_path: Path, examples: int
) -> None:
    found = kill_at_random(tmp_path / "robot", kills=examples, seed=7)
    assert found["the old table"] + found["the new table"] == examples
    assert found["acknowledged revisions"] > 0


def test_cut_anywhere_it_opens_on_the_old_or_the_new_table(tmp_path: Path) -> None:
    found = cut_everywhere(tmp_path, step=4999)
    assert found["log cut short: opened on the old table"] > 10
    assert found["log half copied: opened on the new table"] > 10
