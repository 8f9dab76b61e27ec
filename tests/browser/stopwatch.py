"""Times what a person waits for, inside the page: from a release of the pointer to the sight of
what it led to."""

from __future__ import annotations

from playwright.sync_api import Page

# The browser's own time of the release, up to the end of the frame that shows the awaited thing.
_ARM = """(sight) => {
  const lap = { released: null };
  window.kompassLap = new Promise((done) => { lap.done = done; });
  let drawing = false;
  const release = (event) => { lap.released = event.timeStamp; };
  addEventListener("pointerup", release, true);
  const look = () => {
    if (drawing || lap.released === null || document.querySelector(sight) === null) return;
    drawing = true;
    watch.disconnect();
    removeEventListener("pointerup", release, true);
    requestAnimationFrame(() => setTimeout(() => lap.done(performance.now() - lap.released), 0));
  };
  const watch = new MutationObserver(look);
  watch.observe(document.body, {
    subtree: true, childList: true, characterData: true,
    attributes: true, attributeFilter: ["data-phase"],
  });
}"""
# Told by the page when it is over: to look again and again takes frames of what is timed.
_READ = """(timeout) => Promise.race([
  window.kompassLap,
  new Promise((_, late) => setTimeout(() => late(new Error("not seen in time")), timeout)),
])"""

# With an answer the goal's card has a button to send it, or to send the nearest point instead.
ANSWERED = '[data-testid="goal-go"], [data-testid="goal-nearest"]'
ACCEPTED = ", ".join(
    f'[data-testid="goal-status"][data-phase="{phase}"]'
    for phase in ("accepted", "driving", "arrived")
)


class Stopwatch:
    """Armed before the hand moves, read when ``sight`` (a CSS selector) has been seen."""

    def __init__(self, page: Page, sight: str) -> None:
        self._page = page
        page.evaluate(_ARM, sight)

    def read(self, timeout: float = 10.0) -> float:
        """Milliseconds from the last release before to the end of the frame that shows it."""
        return float(self._page.evaluate(_READ, timeout * 1000))
