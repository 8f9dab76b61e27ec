"""The documentation builds without the network, asks nobody for anything, and can be searched."""

from __future__ import annotations

import functools
import http.server
import os
import re
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.browser.chromium import chromium
from tests.docs.blocks import ROOT

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The built pages; a link or an anchor that leads nowhere is an error."""
    folder = tmp_path_factory.mktemp("site")
    done = subprocess.run(
        [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "--site-dir", str(folder)],
        cwd=ROOT,
        env={**os.environ, "NO_MKDOCS_2_WARNING": "1"},
        text=True,
        capture_output=True,
    )
    assert not done.returncode, done.stdout + done.stderr
    return folder


# What a page loads, as opposed to what it links to.
LOADED = re.compile(
    r"<(?:script|img|iframe|source|video|audio|embed|input)\b[^>]*?\bsrc\s*=\s*[\"']?(?P<src>[^\"'\s>]+)"
    r"|<link\b(?![^>]*rel=[\"']?canonical)[^>]*?\bhref\s*=\s*[\"']?(?P<href>[^\"'\s>]+)"
    r"|<(?:image|use)\b[^>]*?\bhref\s*=\s*[\"']?(?P<use>[^\"'\s>]+)"
)
URL = re.compile(r"url\(\s*[\"']?([^\"')]+)")
ELSEWHERE = re.compile(r"(?:https?:)?//")


def test_no_page_and_no_stylesheet_loads_anything_from_elsewhere(site: Path) -> None:
    found = []
    for page in site.rglob("*.html"):
        for match in LOADED.finditer(page.read_text(encoding="utf-8")):
            found += [(page.name, one) for one in match.groups() if one]
    for sheet in [*site.rglob("*.css"), *site.rglob("*.html"), *site.rglob("*.svg")]:
        found += [(sheet.name, one) for one in URL.findall(sheet.read_text(encoding="utf-8"))]
    assert found, "the pages load nothing at all; the patterns are wrong"
    assert not [one for one in found if ELSEWHERE.match(one[1])]


def test_generated_pages_tell_what_the_code_has(site: Path) -> None:
    def text(name: str) -> str:
        return (site / "reference" / name).read_text(encoding="utf-8")

    assert "critical_zone_distance" in text("settings.html")
    assert "first_true_is_edge" in text("rule-schema.html")
    assert "kompass_interfaces/srv/ApplyRules" in text("interfaces.html")
    assert "/api/stop/release" in text("http.html")
    assert "--single-process" in text("command-line.html")
    assert "KOMPASS_PROBATION" in text("environment.html")
    assert "launcher.bringup" in re.sub(r"<[^>]+>", "", text("recipes.html"))


class _Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_: object) -> None:
        pass


@pytest.fixture
def address(site: Path) -> Iterator[str]:
    handler = functools.partial(_Quiet, directory=str(site))
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        yield f"http://127.0.0.1:{server.server_port}/"
        server.shutdown()
        thread.join()


@pytest.mark.browser
def test_a_reader_finds_a_word_and_nobody_else_is_asked(address: str) -> None:
    asked: list[str] = []
    with chromium() as browser:
        page = browser.new_page(viewport={"width": 390, "height": 844})
        page.on("request", lambda request: asked.append(request.url))
        for name in ("index", "start", "architecture", "rules-by-example", "reference/settings"):
            page.goto(f"{address}{name}.html")
            wide = page.evaluate("document.documentElement.scrollWidth - window.innerWidth")
            assert wide <= 0, f"{name} is wider than a phone"
        page.set_viewport_size({"width": 1280, "height": 900})
        page.goto(f"{address}index.html")
        page.get_by_placeholder("Search").click()
        page.keyboard.type("cooldown")
        results = page.locator(".md-search-result__item")
        results.first.wait_for(timeout=20_000)
        assert results.count() > 1
    assert not [url for url in asked if not url.startswith(address)]
