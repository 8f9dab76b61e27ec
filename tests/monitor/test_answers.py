"""Answers of the monitor's services stay within bounds."""

from kompass_interfaces.srv import GetFirings

from kompass.monitor.services import LARGEST, answer_in_parts
from kompass.rulebook.schema.journal import FiringRecord, Journal


def test_a_long_answer_comes_in_parts() -> None:
    entry = FiringRecord(
        number=1, epoch="e", run_id=1, rule_id="r", name="", kind="note", time=0.0, revision=1,
        rule_hash="", severity="info", text="x" * 3000,
    )  # fmt: skip
    firings = tuple(entry.model_copy(update={"number": 1000 - n}) for n in range(1000))

    answer = answer_in_parts(GetFirings.Response(), Journal(firings=firings, more=False), "firings")

    told = Journal.model_validate_json(answer.answer)
    assert answer.success
    assert len(answer.answer) <= LARGEST
    assert 250 < len(told.firings) < 400
    assert told.firings == firings[: len(told.firings)], "the newest"
    assert told.more
