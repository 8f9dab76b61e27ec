"""The console's page, in the words of who uses it."""

from __future__ import annotations

import io
import re
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from PIL import Image
from playwright.sync_api import Error, Locator, Page, Request, WebSocket, expect

from tests.browser.floor import Floor, Point
from tests.support.processes import wait_until

# The scene's first picture is drawn by the processor, after megabytes of program were compiled.
FIRST_PICTURE = 30.0
_WATCH_POLICY = """
window.policyViolations = [];
addEventListener("securitypolicyviolation", (event) =>
  window.policyViolations.push(`${event.effectiveDirective}: ${event.blockedURI}`));
"""
_PROBES: list[Point] = [(0.35, 0.35), (0.65, 0.35), (0.3, 0.7), (0.7, 0.7), (0.5, 0.5)]

# Whether the element, and nothing else, is what a finger would hit all over it.
UNCOVERED = """(element) => {
  const box = element.getBoundingClientRect();
  return [[0.5, 0.5], [0.2, 0.2], [0.8, 0.2], [0.2, 0.8], [0.8, 0.8]].every(([u, v]) => {
    const hit = document.elementFromPoint(box.left + u * box.width, box.top + v * box.height);
    return hit !== null && element.contains(hit);
  });
}"""


class ConsolePage:
    """One browser page on one console; keeps what it asked for and what went wrong in it."""

    def __init__(self, page: Page, origin: str) -> None:
        self.page = page
        self.origin = origin
        self.requests: list[str] = []
        self.errors: list[str] = []
        page.on("request", self._requested)
        page.on("websocket", self._connected)
        page.on("pageerror", self._failed)
        page.add_init_script(_WATCH_POLICY)

    def _requested(self, request: Request) -> None:
        self.requests.append(request.url)

    def _connected(self, socket: WebSocket) -> None:
        self.requests.append(socket.url)

    def _failed(self, error: Error) -> None:
        self.errors.append(f"{error.message}\n{error.stack}")

    def policy_violations(self) -> list[str]:
        """What the page and its scene tried, and their content policies refused."""
        asked = "() => window.policyViolations ?? []"
        return [tried for frame in self.page.frames for tried in frame.evaluate(asked)]

    def get(self, test_id: str) -> Locator:
        """An element by its test id."""
        return self.page.get_by_test_id(test_id)

    def open(self, token: str) -> None:
        """Follow the printed link, as far as the scene being drawn and the robot being known."""
        self._follow(token)
        self.await_scene()

    def open_flat(self, token: str) -> None:
        """Follow the printed link as far as the robot being known, on a page without its scene."""
        self.leave_scene_out()
        self._follow(token)

    def leave_scene_out(self) -> None:
        """Have nothing in the scene's frame: to draw it takes the processor longer than most
        tests take for all else."""
        self.page.route("**/scene/**", lambda route: route.fulfill(body=""))

    def let_scene_in(self) -> None:
        """Load the page again, with the scene that was left out."""
        self.page.unroute("**/scene/**")
        self.page.reload()
        self.await_scene()

    def _follow(self, token: str) -> None:
        self.page.goto(f"{self.origin}/#token={token}")
        expect(self.get("pose")).to_contain_text("m/s", timeout=FIRST_PICTURE * 1000)

    def await_scene(self) -> Floor:
        """Wait until the camera has come to rest; the floor as it is seen then."""
        seen: list[list[Point]] = []

        def at_rest() -> bool:
            points = self._probe()
            if points is None:
                return False
            seen.append(points)
            return len(seen) > 1 and np.allclose(seen[-1], seen[-2], atol=0.002)

        wait_until(at_rest, FIRST_PICTURE, "a scene at rest")
        self.page.context.request.delete(
            f"{self.origin}/api/views/{self.view}/preview", headers={"Origin": self.origin}
        )
        return Floor(seen[-1], _PROBES)

    def _probe(self) -> list[Point] | None:
        """What floor points the console takes the probed pixels for."""
        points = []
        for start in _PROBES:
            answer = self.post("/api/goals/check", {"view": self.view, "start": list(start)})
            if not answer.ok:
                return None
            check = answer.json()
            points.append((float(check["x"]), float(check["y"])))
        return points if len(set(points)) == len(points) else None

    def post(self, path: str, body: object) -> Any:
        """A request with this page's session, beside the page."""
        return self.page.context.request.post(
            self.origin + path, data=body, headers={"Origin": self.origin}
        )

    @property
    def view(self) -> str:
        """Id of this page's scene."""
        source = self.get("scene-frame").get_attribute("src") or ""
        found = re.fullmatch(r"/scene/([^/]+)/", source)
        assert found, source
        return found[1]

    def pixel(self, floor: Floor, x: float, y: float) -> Point:
        """Where on the page a point of the floor is."""
        box = self.get("scene-frame").bounding_box()
        assert box is not None
        u, v = floor.project(x, y)
        assert max(abs(u - 0.5), abs(v - 0.5)) < 0.5, f"({x}, {y}) is not in the picture"
        return box["x"] + u * box["width"], box["y"] + v * box["height"]

    def picture(self) -> npt.NDArray[np.uint8]:
        """What the whole page looks like, (height, width, 3)."""
        return np.array(Image.open(io.BytesIO(self.page.screenshot(scale="css"))).convert("RGB"))

    def pick(self, at: Point, towards: Point | None = None) -> None:
        """Turn the goal tool on, press at a pixel, drag and release; without a drag it is a tap."""
        if self.get("goal-overlay").count() == 0:
            self.get("goal-tool").click()
        expect(self.get("goal-overlay")).to_be_visible()
        self.page.mouse.move(*at)
        self.page.mouse.down()
        if towards is not None:
            self.page.mouse.move(*towards, steps=6)
        self.page.mouse.up()

    def release_stop(self) -> None:
        """Hold the release until it has worked."""
        self.get("release-button").hover()
        self.page.mouse.down()
        expect(self.get("stop-band")).to_be_hidden()
        self.page.mouse.up()

    def keep(self, name: str) -> Path:
        """Keep a picture of the page among the artefacts."""
        file = Path("artifacts") / f"{re.sub(r'[^A-Za-z0-9_.-]+', '-', name)}.png"
        file.parent.mkdir(exist_ok=True)
        self.page.screenshot(path=file)
        return file
