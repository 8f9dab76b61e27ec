"""How long the hand waits for the page: from a drag's release to its answer, from Go to accepted.

    .venv/bin/python benchmarks/goal_latency.py [COUNT] [--not-drawn]

Measured in the page, from the browser's own time of the release to the end of the frame that shows
the answer. Without a GPU the scene is drawn by the processor, which it shares with the robot's
programs and with the page; so every other goal is timed while the scene draws nothing; with
--not-drawn, all are.
"""

import statistics
import sys
from collections import defaultdict
from pathlib import Path

from playwright.sync_api import ViewportSize, expect

sys.path.insert(0, str(Path(__file__).parents[1]))
from benchmarks.common import percentile
from tests.browser.chromium import chromium
from tests.browser.console_page import ConsolePage
from tests.browser.floor import FAR_APART, Floor
from tests.browser.stopwatch import ACCEPTED, ANSWERED, Stopwatch
from tests.support.robot import Robot
from tests.support.stack import TOKEN, Stack

WINDOW: ViewportSize = {"width": 1440, "height": 900}
# Taken in turn and canceled when accepted: the robot sets out and never arrives.
GOALS = FAR_APART

_PAUSE = """() => {
  const scene = document.querySelector('[data-testid="scene-frame"]').contentWindow;
  scene.kompassDraw = scene.requestAnimationFrame;
  scene.kompassHeld = [];
  scene.requestAnimationFrame = (frame) => scene.kompassHeld.push(frame);
}"""
_RESUME = """() => {
  const scene = document.querySelector('[data-testid="scene-frame"]').contentWindow;
  scene.requestAnimationFrame = scene.kompassDraw;
  scene.kompassHeld.forEach((frame) => scene.requestAnimationFrame(frame));
}"""


def main() -> None:
    count = int(next((word for word in sys.argv[1:] if word.isdigit()), "50"))
    ways = (False,) if "--not-drawn" in sys.argv else (True, False)
    times: dict[tuple[str, bool], list[float]] = defaultdict(list)
    stack = Stack.simulated()
    try:
        robot = Robot(stack.domain)
        robot.ready()
        robot.close()  # an ear on every topic of the robot, which nobody has who drives it
        with chromium() as browser:
            page = ConsolePage(browser.new_page(viewport=WINDOW), stack.url)
            page.open(TOKEN)
            floor = page.await_scene()
            for number in range(count):
                goal = GOALS[number % len(GOALS)]
                for drawn in ways:
                    if not drawn:
                        page.page.evaluate(_PAUSE)
                    answered, accepted = time_goal(page, floor, *goal)
                    if not drawn:
                        page.page.evaluate(_RESUME)
                    times["drag released → answer at the pointer", drawn].append(answered)
                    times["Go released → accepted", drawn].append(accepted)
    finally:
        stack.close()
    print(f"{count} goals each, ms{'median':>48}{'p95':>8}{'p99':>8}{'worst':>8}")
    for (what, drawn), values in times.items():
        shown = "scene drawn by the processor" if drawn else "scene not drawn"
        print(
            f"{what:38} {shown:30}{statistics.median(values):6.0f}"
            f"{percentile(values, 0.95):8.0f}{percentile(values, 0.99):8.0f}{max(values):8.0f}"
        )


def time_goal(page: ConsolePage, floor: Floor, x: float, y: float) -> tuple[float, float]:
    """One goal by hand, canceled again: ms until its answer, ms until it is accepted."""
    answer = Stopwatch(page.page, ANSWERED)
    page.pick(page.pixel(floor, x, y), page.pixel(floor, x + 0.4, y))
    answered = answer.read()
    box = page.get("goal-go").bounding_box()
    assert box is not None
    page.page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    acceptance = Stopwatch(page.page, ACCEPTED)
    page.page.mouse.down()
    page.page.mouse.up()
    accepted = acceptance.read()
    page.post("/api/goals/cancel", None)
    expect(page.get("goal-status")).to_have_attribute("data-phase", "canceled")
    return answered, accepted


if __name__ == "__main__":
    main()
