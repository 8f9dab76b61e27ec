"""viser's own client page, made part of ours: quiet, themed, and never silently frozen."""

from __future__ import annotations

import functools
from pathlib import Path

import viser

# viser's client unpacks a WebAssembly decoder and its program from the page itself.
SCENE_POLICY = (
    "default-src 'none'; script-src 'self' 'unsafe-inline' 'wasm-unsafe-eval' blob:; "
    "style-src 'unsafe-inline'; img-src 'self' data: blob:; font-src data:; worker-src blob:; "
    "connect-src 'self' data: blob:; base-uri 'none'; form-action 'none'; frame-ancestors 'self'"
)

FLOOR_LIGHT = "#eceef0"
FLOOR_DARK = "#171b20"

# The panel would show a scene tree, an editable server address and a save button (on a narrow
# screen it is a sheet of another kind, known by its Paper only); notices and the connection badge
# are the page's business. The canvas is transparent where nothing is drawn.
_STYLE = f"""
[data-testid="floating-panel"], [data-testid="control-panel"], .mantine-Paper-root,
.mantine-Notifications-root, .mantine-Modal-root {{ display: none !important; }}
html, body {{ background: {FLOOR_LIGHT}; }}
canvas[data-engine] {{ background: {FLOOR_LIGHT}; }}
html[data-mantine-color-scheme="dark"], html[data-mantine-color-scheme="dark"] body,
html[data-mantine-color-scheme="dark"] canvas[data-engine] {{ background: {FLOOR_DARK}; }}
"""

# hasFocus: viser connects again only while its document has the focus; inside a frame it hardly
# ever has, and a dropped scene would stay frozen. fixedDpr: it lowers its resolution for good
# when a frame is slow, and text and walls blur; sharp pixels up to twice the CSS size are kept.
# Keys pressed while the scene has the focus (Space is STOP) belong to the page around it, and
# viser's own shortcuts (a command palette) are kept from it. While the page drives by hand, the
# keys that drive are told by their place, down and up, and move no camera; who leaves the frame
# with one of them held has let go.
# requestAnimationFrame: the scene is drawn whenever something in it has moved, some 25 times a
# second. Where there is no graphics processor that takes more than one of the machine's others, so
# there it is drawn ten times a second while nobody turns it, which is enough to see a robot drive.
# Function: as it starts, viser compiles what calls its sorter of Gaussian splats from strings,
# which the policy refuses, and the browser's console shows an error at each load. There are no
# splats here: these calls are made of nothing. All other strings are left to the policy.
_SCRIPT = """
Document.prototype.hasFocus = function () { return true; };
window.Function = new Proxy(Function, {
  apply: function (native, self, parts) {
    if (parts[0] !== "humanName") return Reflect.apply(native, self, parts);
    return function () {
      return function () { throw new EvalError("No splats are drawn here."); };
    };
  }
});
(function () {
  var query = new URLSearchParams(location.search);
  query.set("fixedDpr", String(Math.min(window.devicePixelRatio || 1, 2)));
  history.replaceState(null, "", "?" + query.toString());
  var drives = /^(Key[WASDQE]|Arrow(Up|Down|Left|Right))$/;
  function hand(event, down) {
    if (!drives.test(event.code) || parent.document.documentElement.dataset.hand === undefined)
      return false;
    event.stopImmediatePropagation();
    event.preventDefault();
    if (!event.repeat)
      parent.postMessage({ kompass: "hand", code: event.code, down: down }, location.origin);
    return true;
  }
  window.addEventListener("keyup", function (event) { hand(event, false); }, true);
  window.addEventListener("blur", function () {
    parent.postMessage({ kompass: "left" }, location.origin);
  });
  window.addEventListener("keydown", function (event) {
    var chord = event.ctrlKey || event.metaKey || event.altKey;
    if (chord) parent.postMessage({ kompass: "left" }, location.origin);
    else if (hand(event, true)) return;
    var stop = event.key === " " || event.code === "Space";
    if (chord) event.stopImmediatePropagation();
    if (!event.repeat && (stop || !chord))
      parent.postMessage({ kompass: "key", key: stop ? " " : event.key }, location.origin);
  }, true);
  var watch = new MutationObserver(function () {
    if (!document.querySelector("canvas")) return;
    watch.disconnect();
    requestAnimationFrame(function () {
      parent.postMessage({ kompass: "ready" }, location.origin);
    });
  });
  watch.observe(document, { childList: true, subtree: true });
})();
(function () {
  var period = 100, turning = 1000, opening = 5000;  // ms
  var gl = document.createElement("canvas").getContext("webgl");
  if (gl === null) return;
  var told = gl.getExtension("WEBGL_debug_renderer_info");
  var renderer = gl.getParameter(told === null ? gl.RENDERER : told.UNMASKED_RENDERER_WEBGL);
  var free = gl.getExtension("WEBGL_lose_context");
  if (free !== null) free.loseContext();
  if (!/swiftshader|llvmpipe|softpipe|basic render/i.test(renderer)) return;
  var native = window.requestAnimationFrame.bind(window);
  var waiting = new Map(), last = 0, asked = false;
  var drawn = -period, hurried = performance.now() + opening;
  function draw(now) {
    asked = false;
    drawn = now;
    var due = Array.from(waiting.values());
    waiting.clear();
    due.forEach(function (each) {
      try { each(now); } catch (error) { reportError(error); }
    });
  }
  window.requestAnimationFrame = function (callback) {
    waiting.set(++last, callback);
    if (!asked) {
      asked = true;
      var now = performance.now();
      var rest = now < hurried ? 0 : drawn + period - now;
      // The next turn of the screen comes some milliseconds after it is asked for.
      if (rest > 8) setTimeout(native, rest - 8, draw);
      else native(draw);
    }
    return last;
  };
  window.cancelAnimationFrame = function (id) { waiting.delete(id); };
  ["pointerdown", "pointermove", "wheel", "keydown"].forEach(function (kind) {
    window.addEventListener(kind, function (event) {
      if (kind !== "pointermove" || event.buttons !== 0)
        hurried = Math.max(hurried, performance.now() + turning);
    }, { capture: true, passive: true });
  });
})();
"""


@functools.cache
def scene_page() -> bytes:
    """The page served at /scene/{id}/.

    Raises
    ------
    RuntimeError
        When the installed viser's client page has another form.
    """
    file = Path(viser.__file__).parent / "client" / "build" / "index.html"
    html = file.read_text(encoding="utf-8")
    head = "<head>"
    if html.count(head) != 1:
        raise RuntimeError(f"{file} has no single <head>; install viser 1.1.1 again")
    ours = f"{head}<script>{_SCRIPT}</script><style>{_STYLE}</style>"
    return html.replace(head, ours, 1).encode()
