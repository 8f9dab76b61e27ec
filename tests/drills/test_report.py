"""Reports tell the same of the same drives, byte for byte, and ask nobody for anything."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path

import pytest

from kompass.drills.draw import DrawOptions
from kompass.drills.report_html import PICTURED, report_html
from kompass.drills.report_json import Report, TableName, make_report, read_report, report_json
from kompass.drills.requirement import parse_requirements
from kompass.rules.schema.table import Table
from tests.browser.chromium import chromium
from tests.drills.drives import gave_up, recovered, touched, undisturbed

OLD = TableName.of("in force", Table())
NEW = TableName.of("<proposed>.yaml", Table())


def drill(*, compared: bool = True, drives: int = 12) -> Report:
    names = [f"7-{n}" for n in range(drives)]
    after = [recovered(names[0], halt=5.0), touched(names[1]), *map(recovered, names[2:])]
    before = [recovered(names[0], halt=5.0), recovered(names[1]), *map(gave_up, names[2:])]
    return make_report(
        recipe="02_self_healing.py",
        table=NEW,
        drives=after,
        against=OLD if compared else None,
        drives_against=before[::-1] if compared else (),
        seed=7,
        requirements=parse_requirements("recovered >= 0.99, contacts == 0, gave_up == 0"),
    )


def test_the_same_drives_give_the_same_bytes_in_whatever_order_they_ended() -> None:
    report = drill()
    again = make_report(
        recipe=report.recipe,
        table=NEW,
        drives=report.drives[::-1],
        against=OLD,
        drives_against=report.drives_against[3:] + report.drives_against[:3],
        seed=7,
        requirements=parse_requirements("recovered >= 0.99, contacts == 0, gave_up == 0"),
    )
    assert report_json(again) == report_json(report)
    assert report_html(again) == report_html(report)
    assert [drive.scenario.name for drive in report.drives] == [f"7-{n}" for n in range(12)]


def test_a_report_is_read_back_as_it_was() -> None:
    for report in (drill(), drill(compared=False)):
        text = report_json(report)
        assert read_report(text) == report
        assert report_json(read_report(text)) == text
        assert json.loads(text)["schema"] == "kompass-drill/1"


def test_a_report_of_another_schema_is_refused() -> None:
    text = report_json(drill())
    with pytest.raises(ValueError, match="schema is 'kompass-drill/9'; read here is"):
        read_report(text.replace("kompass-drill/1", "kompass-drill/9"))
    with pytest.raises(ValueError, match="schema is None"):
        read_report("[]")
    with pytest.raises(ValueError, match=r"line 1: .* give a file that a drill has written"):
        read_report("{")
    with pytest.raises(ValueError, match="wind: Extra inputs"):
        read_report(text.replace('"recipe"', '"wind": 3, "recipe"'))


def test_nothing_of_the_machine_is_in_a_report() -> None:
    with pytest.raises(ValueError, match="is a path of some machine"):
        make_report(recipe="/home/ava/r.py", table=NEW, drives=[])


def test_the_sentence_stands_on_top_and_the_failed_requirements_below() -> None:
    text = report_html(drill())
    body = text[text.index("<body>") :]
    sentence = "Recovers in 11 of 12 instead of 2; one new contact."
    assert drill().sentence == sentence
    assert body.index(sentence) < body.index("✖ contacts == 0: not met, it is 1, off by 1")
    assert body.index("not met") < body.index("<h2>Drives that differ (11)</h2>")
    assert "● gave_up == 0: met, it is 0" in body


def test_a_drill_under_one_table_shows_what_went_badly() -> None:
    report = drill(compared=False)
    assert report.sentence == "Recovers in 11 of 12 disturbed drives; 1 contact."
    body = report_html(report)
    assert body.count("<article>") == 1
    assert "Touched barrier_across after 9.0 s." in body
    well = make_report(recipe="r.py", table=NEW, drives=[undisturbed(), recovered("1-1")])
    assert "Every drive came through." in report_html(well)
    assert make_report(recipe="r.py", table=NEW, drives=[]).sentence == "No drive was made."
    calm = make_report(recipe="r.py", table=NEW, drives=[undisturbed()])
    assert calm.sentence == "No fault disturbed any drive."
    assert "<h2>Rules that fired, &lt;proposed&gt;.yaml</h2><p>None.</p>" in report_html(calm)


def test_the_rules_of_both_tables_are_told_and_every_fault_that_began_under_either() -> None:
    report = make_report(
        recipe="r.py",
        table=NEW,
        drives=[undisturbed("1-0")],
        against=OLD,
        drives_against=[undisturbed("1-0").model_copy(update={"firings": recovered().firings})],
    )
    body = report_html(report)
    assert "<h2>Rules that fired, &lt;proposed&gt;.yaml</h2><p>None.</p>" in body
    assert body.index("<h2>Rules that fired, in force</h2>") < body.rindex("stuck-unblock")


def test_faults_that_were_not_drawn_are_told() -> None:
    # A door of another world is nothing that these drives could have met.
    options = DrawOptions(
        worlds=("hexagon",), faults=("way_blocked", "scan_frozen", "door_closed:kitchen")
    )
    few = make_report(recipe="r.py", table=NEW, drives=[recovered()], seed=1, options=options)
    (note,) = few.notes
    assert note == (
        "1 of 2 faults were drawn in these drives, and the others not tried; 2 drives have each of "
        "them"
    )
    one = options.model_copy(update={"faults": ("way_blocked",)})
    whole = make_report(recipe="r.py", table=NEW, drives=[recovered()], seed=1, options=one)
    assert whole.notes == ()


def test_the_page_says_how_to_make_a_drive_of_it_again() -> None:
    drawn = make_report(
        recipe="my robot.py",
        table=NEW,
        drives=[recovered("7-0"), gave_up("7-1")],
        seed=7,
        options=DrawOptions(
            worlds=("hexagon",), faults=("way_blocked", "glass:0.5"), faults_per_drive=2
        ),
    )
    assert (
        "kompass-console drill replay 7-0 --recipe &#x27;my robot.py&#x27; --seed 7 "
        "--worlds hexagon --robot turtlebot3 --faults way_blocked,glass:0.5 "
        "--faults-per-drive 2 -o 7-0.mcap"
    ) in report_html(drawn)
    of_files = report_html(drill())
    assert "--scenario SCENARIO.yaml -o" in of_files
    assert "--worlds" not in of_files


def test_of_many_drives_some_are_drawn_and_the_rest_is_said() -> None:
    text = report_html(drill(drives=PICTURED + 10))
    assert text.count("<article>") == PICTURED
    assert "9 more are not drawn here; the JSON report has all." in text


class _Tags(HTMLParser):
    """Checks that every tag is closed where it must be, and keeps what would be loaded."""

    VOID = ("meta", "br", "use", "rect", "circle", "polygon", "polyline", "path", "line")

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.loads: list[str] = []
        self.text: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.loads += [value or "" for name, value in attrs if name in ("src", "href", "srcset")]
        if tag != "meta":
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.loads += [value or "" for name, value in attrs if name in ("src", "href")]
        assert tag in self.VOID

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.text.append(data)


def test_the_page_is_whole_and_loads_nothing() -> None:
    text = report_html(drill())
    tags = _Tags()
    tags.feed(text)
    assert tags.open == []
    assert {one for one in tags.loads if not one.startswith("#world-")} == set()
    assert "url(" not in text
    assert "@import" not in text
    assert "<script" not in text
    # Names of others are text, wherever they stand.
    assert "<proposed>" not in re.sub(r"<(style|title)>.*?</\1>", "", text, flags=re.DOTALL)
    assert "&lt;proposed&gt;.yaml" in text


@pytest.mark.browser
def test_a_browser_shows_it_on_a_phone_and_in_the_dark_and_asks_nobody(tmp_path: Path) -> None:
    file = tmp_path / "drill.html"
    file.write_text(report_html(drill()), encoding="utf-8")
    asked: list[str] = []
    complaints: list[str] = []
    with chromium() as browser:
        for width, scheme in ((390, "dark"), (1280, "light")):
            page = browser.new_page(
                viewport={"width": width, "height": 844},
                color_scheme="dark" if scheme == "dark" else "light",
            )
            page.on("request", lambda request: asked.append(request.url))
            page.on("console", lambda message: complaints.append(message.text))
            page.goto(file.as_uri())
            assert page.evaluate("document.documentElement.scrollWidth - innerWidth") <= 0
            assert page.get_by_role("heading", level=1).inner_text().startswith("Recovers in 11")
            floor = page.locator("svg.map").first
            assert (floor.bounding_box() or {"height": 0})["height"] > 150
            page.get_by_text("What happened").first.click()
            assert page.get_by_text("way_blocked began").first.is_visible()
            page.close()
    assert asked == [file.as_uri()] * 2
    assert complaints == []


def test_nothing_of_drills_needs_ros_or_physics() -> None:
    program = (
        "import pkgutil, importlib, sys, kompass.drills as package\n"
        "for each in pkgutil.iter_modules(package.__path__):\n"
        "    importlib.import_module('kompass.drills.' + each.name)\n"
        "print(sorted({'rclpy', 'mujoco', 'ompl'} & set(sys.modules)))\n"
    )
    done = subprocess.run([sys.executable, "-c", program], text=True, capture_output=True)
    assert done.stdout.strip() == "[]", done.stdout + done.stderr
