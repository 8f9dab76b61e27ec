/**
 * Says that the robot cannot be reached, where a browser would say that a site is not there.
 *
 * It keeps nothing: no code, no answer, no picture of the robot. The page always comes from the
 * console, so there is none of yesterday's; what the page asks for besides is not looked at here.
 */

/** A robot that does not answer for so long cannot be reached. */
const PATIENCE_MS = 10_000;

const UNREACHABLE = `<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<meta http-equiv="refresh" content="5">
<title>Robot not reached</title>
<style>
  body { margin: 0; min-height: 100dvh; display: grid; place-items: center; padding: 16px;
    box-sizing: border-box; background: #e9ecef; color: #1d2329;
    font: 16px/1.5 system-ui, sans-serif; }
  main { max-width: 420px; padding: 24px; border: 1px solid #d3d8de; border-radius: 12px;
    background: #fff; }
  h1 { margin: 0 0 8px; font-size: 22px; line-height: 1.3; }
  p { margin: 0 0 12px; }
  a { display: inline-block; padding: 10px 16px; border-radius: 8px; background: #1f5fbf;
    color: #fff; text-decoration: none; }
  @media (prefers-color-scheme: dark) {
    body { background: #14181c; color: #e6eaee; }
    main { border-color: #3a434c; background: #1e2429; }
  }
</style>
<main>
  <h1>The robot cannot be reached</h1>
  <p>Its console does not answer. Nothing is known of the robot now, and <b>STOP does not work from
  here</b>: use the emergency stop on the robot itself.</p>
  <p>Look whether the robot is on, and whether this device is in its network. It is tried again
  every five seconds.</p>
  <a href="/">Try now</a>
</main>
</html>
`;

self.addEventListener("install", () => self.skipWaiting());
self.addEventListener("activate", (event) => event.waitUntil(self.clients.claim()));

self.addEventListener("fetch", (event) => {
  const { request } = event;
  if (request.destination !== "document" || new URL(request.url).pathname !== "/") return;
  event.respondWith(
    fetch(request, { signal: AbortSignal.timeout(PATIENCE_MS) }).catch(
      () =>
        new Response(UNREACHABLE, {
          status: 503,
          headers: {
            "Content-Type": "text/html; charset=utf-8",
            "Content-Security-Policy": "default-src 'none'; style-src 'unsafe-inline'",
            "Cache-Control": "no-store",
          },
        }),
    ),
  );
});
