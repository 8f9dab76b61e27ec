"""What is seen of a robot becomes entries: one for each thing, whatever is seen of it again."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from kompass.timeline.entry import LONGEST_TEXT, TimelineEntry
from kompass.timeline.happening import Began, Happened, Happening, Over
from kompass.timeline.log import AGAIN, FLICKERS, TimelineLog


class Kept:
    """A log, and what was kept of it under each number."""

    def __init__(self) -> None:
        self.log = TimelineLog()
        self.entries: dict[int, TimelineEntry] = {}

    def sees(self, *happenings: Happening) -> list[TimelineEntry]:
        """All entries, as they are then."""
        for each in happenings:
            for entry in self.log.take(each):
                self.entries[entry.number] = entry
        return list(self.entries.values())


def test_what_lasts_is_one_entry_from_its_beginning_to_its_end() -> None:
    kept = Kept()
    began = Began(10.0, "fault", "process planner", "Died", "signal 9", "error", "planner")
    (entry,) = kept.sees(began, began._replace(time=11.0))
    assert (entry.time, entry.lasts, entry.ended) == (10.0, True, None)
    (entry,) = kept.sees(Over(12.5, "process planner", "Started again."))
    assert (entry.time, entry.ended, entry.lasts) == (10.0, 12.5, False)
    assert entry.text == "signal 9. Started again."
    assert kept.sees(Over(13.0, "process planner"), Over(13.0, "never heard of")) == [entry]


def test_what_flickers_is_one_entry_that_counts_and_what_comes_later_is_another() -> None:
    kept = Kept()
    for at in (0.0, 3.0, 6.0):
        kept.sees(Began(at, "fault", "scan", "Held"), Over(at + 1.0, "scan"))
    (entry,) = kept.entries.values()
    assert (entry.count, entry.time, entry.ended) == (3, 0.0, 7.0)
    kept.sees(Began(7.0 + FLICKERS, "fault", "scan", "Held"))
    assert [each.count for each in kept.entries.values()] == [3, 1]


def test_another_reason_ends_the_one_before() -> None:
    kept = Kept()
    kept.sees(Began(0.0, "fault", "held", "no scan"), Began(2.0, "fault", "held", "no odometry"))
    first, second = kept.entries.values()
    assert (first.ended, first.lasts, second.lasts) == (2.0, False, True)


def test_what_happens_again_and_again_counts_and_is_told_anew_after_a_while() -> None:
    kept = Kept()
    fired = Happened(0.0, "rule", "unblock", key="rule unblock")
    for at in (0.0, 30.0, 80.0):
        kept.sees(fired._replace(time=at))
    (entry,) = kept.entries.values()
    assert (entry.count, entry.last) == (3, 80.0)
    assert len(kept.sees(fired._replace(time=81.0 + AGAIN))) == 2
    assert len(kept.sees(fired._replace(time=82.0 + AGAIN, key=""))) == 3


def test_after_a_restart_what_still_lasts_goes_on_and_what_is_gone_has_an_unseen_end() -> None:
    before = Kept()
    before.sees(
        Began(1.0, "stop", "stop", "STOP", who="ava"),
        Began(2.0, "fault", "process planner", "Died"),
        Began(3.0, "goal", "goal 7", "Goal 1.00, 2.00"),
    )
    log = TimelineLog(before.log.newest, before.entries.values())
    assert log.take(Began(10.0, "stop", "stop", "STOP", who="ava")) == []
    (ended,) = log.take(Over(11.0, "goal 7", "Arrived."))
    assert (ended.number, ended.ended) == (3, 11.0)
    (unseen,) = log.settle(40.0)
    assert (unseen.title, unseen.lasts, unseen.ended) == ("Died", False, None)
    assert log.settle(41.0) == []
    assert log.newest == 3


HAPPENINGS = st.one_of(
    st.builds(
        Happened,
        st.floats(0, 1e9),
        st.sampled_from(["rule", "person"]),
        st.text(max_size=300),
        st.text(max_size=3000),
        key=st.sampled_from(["", "a", "b"]),
    ),
    st.builds(
        Began,
        st.floats(0, 1e9),
        st.just("fault"),
        st.sampled_from(["a", "b"]),
        st.sampled_from(["x", "y"]),
        st.text(max_size=3000),
    ),
    st.builds(Over, st.floats(0, 1e9), st.sampled_from(["a", "b"]), st.text(max_size=3000)),
)


@given(st.lists(HAPPENINGS, max_size=40))
def test_whatever_happens_entries_are_numbered_bounded_and_end_after_they_began(
    happenings: list[Happening],
) -> None:
    kept = Kept()
    entries = kept.sees(*happenings)
    assert [entry.number for entry in entries] == list(range(1, len(entries) + 1))
    for entry in entries:
        assert TimelineEntry.model_validate_json(entry.model_dump_json()) == entry
        assert len(entry.text) <= LONGEST_TEXT
        assert entry.ended is None or entry.ended >= entry.time or entry.count > 1
        assert entry.lasts == (entry.ended is None)
    lasting = [entry.key for entry in entries if entry.lasts]
    assert len(lasting) == len(set(lasting)), "one of a key lasts at a time"
