/**
 * Takes the one-time token out of the address (`#token=…`) and strips it at once, so that it is
 * neither in the history nor in a screenshot.
 */
export function takeToken(): string | null {
  const token = new URLSearchParams(location.hash.slice(1)).get("token");
  if (location.hash !== "") {
    history.replaceState(history.state, "", location.pathname + location.search);
  }
  return token === null || token === "" ? null : token;
}
