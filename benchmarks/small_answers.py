"""How long a page waits for a small answer of the console, which comes as two packets.

    .venv/bin/python benchmarks/small_answers.py [COUNT]

Where the second packet had to wait for the acknowledgement of the first, no answer but those of the
first moments would come sooner than a delayed acknowledgement (40 ms on Linux).
"""

import statistics
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
from benchmarks.common import percentile
from kompass_console.schema.roles import Role
from tests.console.conftest import serving
from tests.support.domains import next_domain

DELAYED_ACKNOWLEDGEMENT = 40.0  # ms
FIRST = 20  # answers on a new connection are acknowledged at once


def main() -> None:
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    took = []
    with (
        tempfile.TemporaryDirectory() as folder,
        serving(Path(folder) / "audit.jsonl", next_domain()) as served,
        served.client(Role.VIEWER) as client,
    ):
        for _ in range(FIRST + count):
            began = time.perf_counter()
            client.get("/api/session").raise_for_status()
            took.append((time.perf_counter() - began) * 1e3)
    took = took[FIRST:]
    print(
        f"{count} answers, ms: median {statistics.median(took):.1f}, "
        f"p95 {percentile(took, 0.95):.1f}, least {min(took):.1f}, worst {max(took):.1f}; "
        f"a delayed acknowledgement takes {DELAYED_ACKNOWLEDGEMENT:.0f}"
    )


if __name__ == "__main__":
    main()
