"""What the benchmarks share: a stack as a user starts it, and the kernel's own accounting."""

import statistics
from pathlib import Path

TICKS = 100  # of /proc/<pid>/stat a second


def pss(pid: int) -> float:
    """Proportional share of memory [MiB]."""
    for line in Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines():
        if line.startswith("Pss:"):
            return int(line.split()[1]) / 1024
    raise RuntimeError(f"the kernel does not tell the PSS of process {pid}")


def cpu_seconds(pid: int) -> float:
    """User and system time so far [s]."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / TICKS


def spread(values: list[float]) -> str:
    """Median, and the range."""
    return f"{statistics.median(values):.2f} ({min(values):.2f} … {max(values):.2f})"


def percentile(values: list[float], share: float) -> float:
    """Nearest-rank percentile."""
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, int(share * len(ordered)))]
