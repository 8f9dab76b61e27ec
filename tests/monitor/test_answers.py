"""Answers of the monitor's services stay within bounds; who wants more asks on."""

import pytest
from kompass_interfaces.srv import GetFirings

from kompass.monitor import services
from kompass.monitor.services import LARGEST, answer_in_parts
from kompass.rulebook.schema.journal import FiringRecord, Journal
from kompass_console.rules_cli.looking import in_parts


def entry(number: int, size: int) -> FiringRecord:
    return FiringRecord(
        number=number,
        epoch="a",
        run_id=number,
        rule_id="r",
        name="",
        kind="firing",
        time=float(number),
        revision=1,
        rule_hash="",
        severity="info",
        message="x" * size,
    )


def test_a_long_answer_comes_in_parts() -> None:
    firings = tuple(entry(1000 - n, 3000) for n in range(1000))

    answer = answer_in_parts(GetFirings.Response(), Journal(firings=firings, more=False), "firings")

    told = Journal.model_validate_json(answer.answer)
    assert answer.success
    assert len(answer.answer) <= LARGEST
    assert LARGEST // 4000 < len(told.firings) < LARGEST // 2500
    assert told.firings == firings[: len(told.firings)], "the newest"
    assert told.more


@pytest.mark.parametrize("size", [0, 700, 5_000])
@pytest.mark.parametrize("wanted", [1, 30, 119, 120, 1000])
def test_all_that_is_wanted_comes_in_answers_that_are_not_larger(
    monkeypatch: pytest.MonkeyPatch, size: int, wanted: int
) -> None:
    largest = 4_000
    monkeypatch.setattr(services, "LARGEST", largest)
    kept = [entry(number, size) for number in range(120, 0, -1)]
    sizes: list[int] = []

    def ask(before: int, count: int) -> Journal:
        found = [one for one in kept if not before or one.number < before]
        journal = Journal(firings=tuple(found[:count]), more=len(found) > count)
        response = answer_in_parts(GetFirings.Response(), journal, "firings")
        sizes.append(len(response.answer))
        return Journal.model_validate_json(response.answer)

    journal = in_parts(ask, "firings", 0, wanted)
    assert [one.number for one in journal.firings] == [one.number for one in kept][:wanted]
    assert journal.more == (wanted < len(kept))
    if size < largest:  # one alone is told whatever it has
        assert max(sizes) <= largest
