"""Small answers are sent at once."""

import time

from kompass_console.schema.roles import Role
from tests.console.conftest import Served

# A browser's system waits this long before it acknowledges a part of an answer.
DELAYED_ACKNOWLEDGEMENT = 0.040  # s


def test_no_answer_waits_for_the_acknowledgement_of_its_first_half(console: Served) -> None:
    took = []
    with console.client(Role.VIEWER) as client:
        for _ in range(40):
            began = time.perf_counter()
            assert client.get("/api/session").status_code == 200
            took.append(time.perf_counter() - began)
    # A new connection is acknowledged at once for a while; later each half would wait, even on a
    # machine that is never busy.
    assert min(took[20:]) < 0.75 * DELAYED_ACKNOWLEDGEMENT
