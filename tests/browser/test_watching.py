"""Who opens the page sees the robot, on any screen, and nothing that is not so."""

import os
import re
import signal

import pytest
from playwright.sync_api import Locator, expect

from kompass_console.accounts.accounts import Accounts
from kompass_console.accounts.passwords import hashed
from kompass_console.schema.roles import Role
from tests.browser.conftest import OpenPage
from tests.browser.console_page import FIRST_PICTURE, UNCOVERED, ConsolePage
from tests.support.patience import patient
from tests.support.processes import held, wait_until
from tests.support.robot import Robot
from tests.support.stack import TOKEN, Stack

pytestmark = pytest.mark.browser


def test_the_printed_link_logs_in_and_its_token_leaves_the_address_bar(new_page: OpenPage) -> None:
    page = new_page()
    page.open_flat(TOKEN)
    assert page.page.url == f"{page.origin}/"
    assert TOKEN not in page.page.evaluate("() => JSON.stringify(history.state) + location.href")
    page.page.reload()
    expect(page.get("scene-frame")).to_be_visible()


def test_a_wrong_token_is_told_in_a_sentence_and_a_right_one_lets_in(new_page: OpenPage) -> None:
    page = new_page()
    page.leave_scene_out()
    page.page.goto(f"{page.origin}/#token=not-the-token-at-all")
    expect(page.page.get_by_role("status")).to_contain_text("This token is not one of this")
    assert "not-the-token" not in page.page.url
    page.get("login-token").fill("another wrong token")
    page.get("login-submit").click()
    expect(page.get("login-error")).to_contain_text("Copy the token that the console printed")
    assert page.get("scene-frame").count() == 0
    page.get("login-token").fill(TOKEN)
    page.get("login-submit").click()
    expect(page.get("scene-frame")).to_be_visible()


def test_people_log_in_by_name_and_end_what_they_left_open_elsewhere(
    new_page: OpenPage, stack: Stack
) -> None:
    accounts = Accounts(stack.data_dir / "accounts.json")
    accounts.add("Ava Berg", Role.OPERATOR, hashed("four words of hers"))
    here, there = new_page(390, 844, has_touch=True), new_page()
    try:
        for page in (here, there):
            page.leave_scene_out()
            page.page.goto(page.origin)
            page.get("login-name").fill("ava berg")
            page.get("login-password").fill("guessed at random")
            page.get("login-submit").click()
            expect(page.get("login-error")).to_contain_text("do not fit")
            page.keep("login-by-name-on-a-phone" if page is here else "login-by-name")
            page.get("login-password").fill("four words of hers")
            page.get("login-password").press("Enter")
            expect(page.get("scene-frame")).to_be_visible()
        here.get("user-menu").tap()
        expect(here.page.get_by_role("menu")).to_contain_text("Ava Berg, operator")
        here.get("logout-others").tap()
        expect(here.get("logout-others")).to_contain_text("Logged out elsewhere")
        expect(there.get("login-name")).to_be_visible()
        here.page.reload()
        expect(here.get("scene-frame")).to_be_visible()
    finally:
        accounts.remove("Ava Berg")
    expect(here.get("login-token")).to_be_visible()


def test_a_viewer_watches_and_may_stop_but_neither_drive_nor_release(
    new_page: OpenPage, stack: Stack, robot: Robot
) -> None:
    found = re.search(r"To watch:\s+\S+#token=(\S+)", stack.output)
    assert found
    page = new_page()
    page.open_flat(found[1])
    expect(page.get("goal-tool")).to_be_disabled()
    expect(page.get("goal-tool")).to_have_attribute("title", re.compile("operator"))
    page.page.keyboard.press("g")
    assert page.get("goal-overlay").count() == 0
    expect(page.get("locate-tool")).to_be_disabled()
    page.page.keyboard.press("o")
    assert page.get("locate-overlay").count() == 0

    page.get("stop-button").click()
    expect(page.get("stop-button")).to_have_attribute("data-phase", "stopped")
    robot.has_stopped()
    expect(page.get("stop-band")).to_contain_text("An operator can release it")
    assert page.get("release-button").count() == 0
    for path, body in (
        ("/api/goals", {"x": 0.55, "y": 0.55, "yaw": None}),
        ("/api/goals/cancel", None),
        ("/api/stop/release", None),
    ):
        answer = page.post(path, body)
        assert answer.status == 403, path
        assert "viewer" in answer.json()["detail"]["title"]
    assert robot.newest["/drive_state"].stopped


@pytest.mark.parametrize(("width", "height"), [(390, 844), (820, 1180)], ids=["phone", "tablet"])
def test_stop_is_never_covered_and_health_is_a_tap_away_on_a_small_screen(
    new_page: OpenPage, width: int, height: int
) -> None:
    page = new_page(width, height, has_touch=True)
    page.open(TOKEN)
    stop = page.get("stop-button")

    def stop_is_free() -> None:
        box = stop.bounding_box()
        assert box is not None
        assert min(box["width"], box["height"]) >= 80
        assert box["x"] + box["width"] <= width
        assert box["y"] + box["height"] <= height
        assert stop.evaluate(UNCOVERED)

    stop_is_free()
    scene = page.page.frame_locator('[data-testid="scene-frame"]')
    expect(scene.locator("button:visible, input:visible")).to_have_count(0)
    if width < 560:
        assert page.get("health-planner").count() == 0
        page.get("tab-health").tap()
    for component in ("planner", "controller", "mapper", "drive_manager"):
        row = page.get(f"health-{component}")
        row.scroll_into_view_if_needed()
        _expect_inside(row, width, height)
    stop_is_free()
    page.get("tab-data").tap()
    expect(page.get("stream-scan")).to_be_visible()
    page.get("tab-data").tap()
    if width < 560:
        page.get("user-menu").tap()
        page.get("help-item").tap()
    else:
        page.get("help").tap()
    stop_is_free()
    page.page.get_by_label("Close help").tap()
    page.get("goal-tool").tap()
    box = page.get("goal-overlay").bounding_box()
    assert box is not None
    page.page.touchscreen.tap(box["x"] + 0.5 * box["width"], box["y"] + 0.6 * box["height"])
    _expect_inside(page.get("goal-card"), width, height)
    stop_is_free()


def _expect_inside(element: Locator, width: int, height: int) -> None:
    """Visible, and no part of it off the screen."""
    expect(element).to_be_in_viewport(ratio=1)
    box = element.bounding_box()
    assert box is not None
    assert box["x"] >= 0
    assert box["x"] + box["width"] <= width
    assert box["y"] + box["height"] <= height


def test_the_map_is_drawn_where_it_is_and_the_robots_pose_is_told(
    page: ConsolePage, robot: Robot
) -> None:
    floor = page.await_scene()
    picture = page.picture().astype(int)

    def brightness(x: float, y: float) -> int:
        across, down = page.pixel(floor, x, y)
        return int(picture[round(down), round(across)].mean())

    pillars = [(1.1 * i, 1.1 * j) for i in (-1, 0, 1) for j in (-1, 0, 1)]
    between = [(1.1 * i + 0.55, 1.1 * j + 0.55) for i in (-1, 0) for j in (-1, 0)]
    walls = [(0.0, 2.42), (0.0, -2.42)]
    assert max(brightness(*at) for at in pillars + walls) < 160
    assert min(brightness(*at) for at in between) > 240

    x, y, yaw = robot.truth
    shown = re.findall(r"[-−+]?\d+\.?\d*", page.get("pose").inner_text())
    told = [float(number.replace("−", "-")) for number in shown]
    assert told[:2] == pytest.approx([x, y], abs=0.05)
    assert told[2] == pytest.approx(yaw * 57.3, abs=3)


FRAMES = """(seconds) => new Promise((done) => {
  const end = performance.now() + 1000 * seconds;
  let frames = 0;
  const count = () => {
    frames += 1;
    performance.now() < end ? requestAnimationFrame(count) : done(frames);
  };
  requestAnimationFrame(count);
})"""


def test_a_scene_that_the_processor_has_to_draw_leaves_it_time_for_others(
    page: ConsolePage,
) -> None:
    page.await_scene()
    scene = next(frame for frame in page.page.frames if "/scene/" in frame.url)
    # While it opens it is drawn as fast as it can be.
    wait_until(lambda: scene.evaluate(FRAMES, 1.0) <= 14, 10, "some ten pictures a second")
    assert scene.evaluate(FRAMES, 2.0) <= 28


def test_a_dead_console_freezes_the_view_visibly_and_comes_back_by_itself(
    page: ConsolePage, stack: Stack
) -> None:
    # What the console has not answered before it hangs, the page takes back.
    with page.page.expect_response(lambda answer: answer.request.method == "PATCH"):
        page.get("top-view").click()
    expect(page.get("top-view")).to_have_attribute("aria-pressed", "true")
    before = page.view
    killed = stack.pid_of("console")
    # It hangs before it dies, or it would be back sooner than a view counts as frozen; what hangs
    # is killed by its supervisor.
    os.kill(killed, signal.SIGSTOP)
    expect(page.get("stale-band")).to_contain_text("View is frozen")
    expect(page.get("overall")).to_have_attribute("data-level", "unknown")

    wait_until(lambda: stack.pid_of("console") != killed, 10, "another console")
    expect(page.get("stale-band")).to_be_hidden(timeout=FIRST_PICTURE * 1000)
    assert page.get("login-token").count() == 0
    wait_until(lambda: page.view != before, 10, "a scene of the new console")
    expect(page.get("top-view")).to_have_attribute("aria-pressed", "true")
    floor = page.await_scene()
    across, down = page.pixel(floor, 0.0, 0.0)
    assert page.picture()[round(down), round(across)].mean() < 160


def test_rules_that_have_fallen_silent_are_told_of_until_another_monitor_speaks(
    page: ConsolePage, stack: Stack
) -> None:
    hung = stack.pid_of("monitor")
    os.kill(hung, signal.SIGSTOP)
    expect(page.get("overall")).to_contain_text("Rules silent for")
    expect(page.get("overall")).to_have_attribute("data-level", "degraded")
    wait_until(lambda: stack.pid_of("monitor") != hung, 30, "another monitor")
    expect(page.get("overall")).to_contain_text(re.compile("All well|No faults"))


def test_stop_that_is_pressed_while_the_console_is_dead_arrives_when_it_is_back(
    page: ConsolePage, stack: Stack
) -> None:
    killed = stack.pid_of("console")
    # A supervisor that is held starts no other one before the page has drawn that this one is gone.
    with held(stack.process.pid):
        os.kill(killed, signal.SIGKILL)
        page.page.keyboard.press("Space")
        expect(page.get("stop-unconfirmed")).to_contain_text("STOP is sent again until it does")
    wait_until(lambda: stack.pid_of("console") != killed, 10, "another console")
    expect(page.get("stop-button")).to_have_attribute(
        "data-phase", "stopped", timeout=patient(60) * 1000
    )
    page.post("/api/stop/release", None)
    expect(page.get("stop-button")).to_have_attribute("data-phase", "idle")


def test_no_request_leaves_the_machine(page: ConsolePage) -> None:
    for tool in ("follow", "top-view", "help", "theme-toggle", "theme-toggle"):
        page.get(tool).click()
    page.get("layers").click()
    page.get("layer-scan").click()
    page.page.keyboard.press("Escape")
    page.pick((500, 400))
    expect(page.get("goal-card")).to_be_visible()
    allowed = (page.origin, page.origin.replace("http", "ws"), f"blob:{page.origin}", "data:")
    assert len(page.requests) > 8
    assert not [url for url in page.requests if not url.startswith(allowed)]
