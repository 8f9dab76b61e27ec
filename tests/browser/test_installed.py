"""The page as an app of a tablet: installed, updated, and honest when the robot is out of reach."""

from __future__ import annotations

import io
import shutil
import socket
from collections.abc import Iterator
from pathlib import Path

import pytest
from PIL import Image
from playwright.sync_api import Browser, Page, expect

from kompass_console.api import live
from kompass_console.schema.roles import Role
from kompass_console.settings import ConsoleSettings
from tests.browser.console_page import ConsolePage
from tests.console.conftest import TOKENS, domain, serving
from tests.support.patience import patient

__all__ = ["domain"]

pytestmark = pytest.mark.browser

STATIC = ConsoleSettings.model_fields["static_dir"].default
WORKER = "() => navigator.serviceWorker.ready.then(({ active }) => active.scriptURL)"
CONTROLLED = "() => navigator.serviceWorker.controller !== null"


@pytest.fixture
def page(browser: Browser) -> Iterator[Page]:
    """A page of a browser that was never here."""
    context = browser.new_context(viewport={"width": 820, "height": 640})
    yield context.new_page()
    context.close()


def opened(page: Page, origin: str) -> None:
    """Open the page, as far as its worker being in charge of it."""
    page.goto(origin)
    page.wait_for_function(CONTROLLED)


def test_it_can_be_installed_and_its_worker_keeps_nothing(
    page: Page, tmp_path: Path, domain: int
) -> None:
    with serving(tmp_path / "audit", domain) as own:
        watched = ConsolePage(page, own.origin)
        opened(page, own.origin)
        assert page.evaluate(WORKER) == f"{own.origin}/sw.js"
        session = page.context.new_cdp_session(page)
        manifest = session.send("Page.getAppManifest")
        assert manifest["errors"] == []
        assert manifest["url"] == f"{own.origin}/manifest.webmanifest"
        with own.client() as client:
            said = client.get("/manifest.webmanifest")
            assert said.headers["content-type"].startswith("application/manifest+json")
            for icon in said.json()["icons"]:
                picture = client.get(icon["src"])
                assert picture.headers["content-type"].partition(";")[0] == icon["type"]
                if icon["type"] == "image/png":
                    size = Image.open(io.BytesIO(picture.content)).size
                    assert f"{size[0]}x{size[1]}" == icon["sizes"]
            assert client.get("/sw.js").headers["cache-control"] == "no-store"
        assert page.evaluate("() => caches.keys()") == []
        assert watched.policy_violations() == []


def test_a_robot_out_of_reach_is_said_to_be_and_is_back_by_itself(
    page: Page, tmp_path: Path, domain: int
) -> None:
    with serving(tmp_path / "audit", domain) as own:
        port = own.port
        opened(page, own.origin)
        expect(page.get_by_test_id("login-token")).to_be_visible()
    asked = "() => fetch('/api/session').then(() => 'answered', () => 'failed')"
    assert page.evaluate(asked) == "failed"  # what is no page is nobody's business but the page's
    with socket.create_server(("127.0.0.1", port)):  # somebody listens, and never answers
        page.reload(timeout=patient(60) * 1000)
        expect(page.get_by_role("heading")).to_have_text("The robot cannot be reached")
    expect(page.get_by_role("main")).to_contain_text("STOP does not work from here")
    assert page.get_by_test_id("login-token").count() == 0
    page.screenshot(path=Path("artifacts") / "unreachable.png")
    with serving(tmp_path / "audit", domain, port=port):
        expect(page.get_by_test_id("login-token")).to_be_visible()


def test_an_update_is_taken_with_the_next_look_and_nothing_of_before_comes_back(
    page: Page, tmp_path: Path, domain: int
) -> None:
    static = tmp_path / "static"
    shutil.copytree(STATIC, static)
    with serving(tmp_path / "audit", domain, static_dir=static) as own:
        opened(page, own.origin)
        index, worker = static / "index.html", static / "sw.js"
        was = index.read_text(encoding="utf-8")
        index.write_text(was.replace("<title>Kompass Console", "<title>The new page"))
        text = worker.read_text(encoding="utf-8")
        worker.write_text(text.replace("The robot cannot be reached", "The new worker says so"))
        page.evaluate(
            "() => new Promise((changed) =>"
            " { navigator.serviceWorker.oncontrollerchange = () => changed(null);"
            "   navigator.serviceWorker.getRegistration().then((all) => all.update()); })"
        )
        page.reload()
        expect(page).to_have_title("The new page")
    page.reload()
    expect(page.get_by_role("heading")).to_have_text("The new worker says so")


def test_a_page_that_outlives_its_console_says_that_there_is_another_one(
    page: Page, tmp_path: Path, domain: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    page.route("**/scene/**", lambda route: route.fulfill(body=""))
    with serving(tmp_path / "audit", domain) as own:
        port = own.port
        page.goto(f"{own.origin}/#token={TOKENS[Role.OPERATOR]}")
        expect(page.get_by_test_id("scene-frame")).to_be_visible()
        expect(page.get_by_test_id("update-band")).to_be_hidden()
    monkeypatch.setattr(live, "VERSION", "99.0")
    with serving(tmp_path / "audit", domain, port=port):
        band = page.get_by_test_id("update-band")
        expect(band).to_contain_text("The console is 99.0 now")
        # Graver things are told first: no robot is there.
        page.get_by_test_id("bands-more").click()
        band.get_by_role("button").click()
        expect(page.get_by_test_id("scene-frame")).to_be_visible()
        expect(band).to_be_hidden()
