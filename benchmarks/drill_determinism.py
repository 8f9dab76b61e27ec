"""Is a drill the same twice, byte for byte? Facts, report and recordings of as many seeds as given.

    .venv/bin/python benchmarks/drill_determinism.py [SEEDS] [RECIPE]

The second time more of them at a time, while other processes keep the processors busy: nothing of
the machine may show.
"""

import multiprocessing
import os
import sys
import tempfile
import time
from pathlib import Path

from kompass.drills.draw import DrawOptions, draw
from kompass.drills.drive import DriveResult
from kompass.drills.report_json import TableName, make_report, report_json
from kompass.drills.runner.worker import Order, look_at, make_drives
from kompass.rules.schema.table import Table

RECIPE = Path(__file__).parents[1] / "recipes" / "03_events_and_actions.py"


def burn() -> None:
    """Keep a processor busy, as far as others leave it."""
    os.nice(15)
    while True:
        sum(range(10_000))


def drives(folder: Path, recipe: Path, seeds: int, jobs: int) -> str:
    """Make them, each with a recording in the folder; the report."""
    looked = look_at(recipe)
    options = DrawOptions(worlds=("hexagon",), faults=looked.faults(["all"], looked.robot))
    scenarios = [draw(1, number, options) for number in range(seeds)]
    orders = [Order(recipe, each, None, folder / f"{each.name}.mcap") for each in scenarios]
    table = TableName.of("recipe", Table.model_validate_json(looked.table))
    made = [DriveResult.model_validate_json(text) for _, text in make_drives(orders, jobs)]
    return report_json(make_report(recipe=recipe.name, table=table, drives=made, seed=1))


def main(seeds: int, recipe: Path) -> int:
    few = os.cpu_count() or 1
    with tempfile.TemporaryDirectory() as name:
        reports = []
        for jobs, load in ((few, 0), (few + 2, few)):
            folder = Path(name) / str(jobs)
            folder.mkdir()
            # Daemons: they end with this process, whatever becomes of it.
            busy = [multiprocessing.Process(target=burn, daemon=True) for _ in range(load)]
            for each in busy:
                each.start()
            begun = time.monotonic()
            try:
                reports.append(drives(folder, recipe, seeds, jobs))
            finally:
                for each in busy:
                    each.terminate()
                    each.join()
            print(f"{seeds} drives, {jobs} at a time: {time.monotonic() - begun:.0f} s", flush=True)
        files = sorted((Path(name) / str(few)).iterdir())
        differ = [
            file.name
            for file in files
            if file.read_bytes() != (Path(name) / str(few + 2) / file.name).read_bytes()
        ]
        size = sum(file.stat().st_size for file in files)
        print(f"reports: {'the same' if reports[0] == reports[1] else 'DIFFERENT'}")
        print(f"recordings: {len(files) - len(differ)} of {len(files)} the same, {size >> 20} MB")
        for file_name in differ:
            print(f"  {file_name} differs")
    return 1 if differ or reports[0] != reports[1] else 0


if __name__ == "__main__":
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    raise SystemExit(main(count, Path(sys.argv[2]) if len(sys.argv) > 2 else RECIPE))
