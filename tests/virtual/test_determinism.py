"""The same seed gives the same run, whatever happens in it."""

from __future__ import annotations

import os
import subprocess
import sys
from typing import get_args

from hypothesis import strategies as st

from kompass.virtual.network import Conditions
from tests.support.properties import property_test
from tests.virtual.programs import FIXED, Step, What, trace

STEPS = st.builds(
    Step,
    what=st.sampled_from(get_args(What)),
    node=st.integers(0, 3),
    at=st.integers(0, 200),
    topic=st.integers(0, 2),
    reliable=st.booleans(),
    latched=st.booleans(),
)


@property_test(st.lists(STEPS, max_size=14), st.integers(0, 1000), st.booleans(), many=200)
def test_the_same_seed_gives_the_same_run(steps: list[Step], seed: int, lossy: bool) -> None:
    conditions = Conditions(0.0, 0.003, loss=0.3) if lossy else None
    first = trace(steps, seed, conditions)
    assert "\n".join(trace(steps, seed, conditions)).encode() == "\n".join(first).encode()
    dead: set[str] = set()
    for line in first:
        _, name, *text = line.split()
        assert name not in dead, f"of a process that was killed: {line}"
        if text == ["is", "killed"]:
            dead.add(name)


def test_another_seed_gives_another_run() -> None:
    runs = {"\n".join(trace(FIXED, seed)) for seed in range(5)}
    assert len(runs) == 5
    assert all(len(run.splitlines()) > 100 for run in runs)


def test_the_run_is_that_of_every_interpreter() -> None:
    runs = [
        subprocess.run(
            [sys.executable, "-m", "tests.virtual.programs"],
            env={**os.environ, "PYTHONHASHSEED": hash_seed},
            capture_output=True,
            check=True,
        ).stdout
        for hash_seed in ("1", "2")
    ]
    assert runs[0] == runs[1] == "\n".join(trace(FIXED, seed=3)).encode()
