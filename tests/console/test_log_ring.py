"""The robot's log as the console keeps it: bounded, filtered, and honest about what is missing."""

from kompass_console.link.log_ring import LogQuery, LogRing
from kompass_console.link.rosout import level_of, worst
from kompass_console.schema.log_models import LogLevel, LogLine
from kompass_console.schema.plain import plain_lines


def line(text: str, level: LogLevel = "info", node: str = "planner") -> LogLine:
    return LogLine(number=0, time=0.0, level=level, node=node, text=text, where="")


def texts(ring: LogRing, query: LogQuery) -> list[str]:
    return [each.text for each in ring.page(query).lines]


def test_lines_are_found_by_level_logger_and_words_newest_first() -> None:
    ring = LogRing()
    ring.add(
        [
            line("Path found"),
            line("no PATH", "error", "planner.ompl"),
            line("hot", "warning", "planners"),
            line("boom", "fatal", "drive_manager"),
        ]
    )
    assert texts(ring, LogQuery()) == ["boom", "hot", "no PATH", "Path found"]
    assert texts(ring, LogQuery(level="error")) == ["boom", "no PATH"]
    assert texts(ring, LogQuery(node="planner")) == ["no PATH", "Path found"]
    assert texts(ring, LogQuery(text="path")) == ["no PATH", "Path found"]
    assert texts(ring, LogQuery(text="DRIVE")) == ["boom"]
    assert texts(ring, LogQuery(after=2, level="warning")) == ["boom", "hot"]
    page = ring.page(LogQuery(count=1))
    assert (page.more, page.newest) == (True, 4)
    assert page.nodes == ["drive_manager", "planner", "planner.ompl", "planners"]


def test_the_newest_warning_is_known_among_calmer_lines() -> None:
    ring = LogRing()
    ring.add([line("calm")])
    assert (ring.newest, ring.newest_warning) == (1, 0)
    ring.add([line("hot", "warning"), line("calm again")])
    assert (ring.newest, ring.newest_warning) == (3, 2)


def test_what_is_written_all_the_time_pushes_no_error_out() -> None:
    ring = LogRing()
    ring.add([line("the one that matters", "error")])
    for _ in range(1000):
        ring.add([line("tick") for _ in range(10)])
    assert texts(ring, LogQuery(level="error")) == ["the one that matters"]
    assert len(texts(ring, LogQuery(count=10_000))) == 1501


def test_what_was_left_out_is_told_at_the_line_that_comes_after_it() -> None:
    ring = LogRing()
    ring.add([line("before")])
    ring.add([], left_out=3)
    ring.add([line("after"), line("later")], left_out=4)
    assert [each.left_out for each in ring.page(LogQuery()).lines] == [0, 7, 0]


def test_a_page_of_another_life_of_the_console_is_told_all() -> None:
    ring = LogRing()
    ring.add([line("new life")])
    assert texts(ring, LogQuery(after=5000)) == ["new life"]


def test_of_a_flood_the_worst_lines_are_read_in_their_order() -> None:
    def message(level: int, number: int) -> bytes:
        return bytes(12) + bytes([level]) + number.to_bytes(2, "big")

    few = [message(20, number) for number in range(3)]
    assert worst(few, 3) == few
    flood = [message(20, number) for number in range(1000)]
    bad = [message(40, 7), message(50, 8)]
    assert worst([*flood[:300], bad[0], *flood[300:600], bad[1], *flood[600:]], 4) == [
        *bad,
        *flood[-2:],
    ]


def test_levels_of_ros_have_names_and_those_between_count_as_the_lower() -> None:
    named = {number: level_of(number) for number in (0, 10, 20, 30, 35, 40, 50, 255)}
    assert list(named.values()) == [
        *("debug", "debug", "info", "warning", "warning", "error", "fatal", "fatal"),
    ]


def test_a_traceback_keeps_its_lines_and_what_steers_a_terminal_goes() -> None:
    raw = 'Traceback:\n  File "a.py", line 1\n\tboom()\n\x1b[31mred\u202e\x00'
    assert plain_lines(raw) == 'Traceback:\n  File "a.py", line 1\n boom()\n[31mred'
    assert len(plain_lines("x" * 100_000)) == 2000
    assert plain_lines("\n".join(map(str, range(500)))).count("\n") == 60
