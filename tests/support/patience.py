"""How long the tests wait before they call a promise of promptness broken.

Several files of tests run at a time, each with processes of its own, on whatever machine there is.
So every limit that is stated in a test is that of a quiet machine, and is stretched here; what
holds on a quiet machine is shown with ``KOMPASS_TEST_PATIENCE=1``, and measured in ``benchmarks/``.
"""

import os

PATIENCE = float(os.environ.get("KOMPASS_TEST_PATIENCE", "4"))


def patient(seconds: float) -> float:
    """The limit that stands for ``seconds`` on a quiet machine."""
    return seconds * PATIENCE
