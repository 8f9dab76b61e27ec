import { useCallback, useEffect, useState } from "react";
import { currentSession, login, logout } from "./api/client";
import { ApiError, asApiError } from "./api/errors";
import type { Session } from "./api/types";
import { ConsolePage } from "./frame/ConsolePage";
import { WithStopLeft } from "./frame/PageFailed";
import { LoginPage } from "./session/LoginPage";
import { SessionContext } from "./session/SessionContext";
import { takeToken } from "./session/token";
import { OpenStop } from "./stop/OpenStop";
import { t } from "./texts/text";
import { told } from "./texts/told";

type Gate =
  | { at: "opening" }
  | { at: "login"; notice: string | null }
  | { at: "inside"; session: Session };

/** Who is here? A token from the address first, else this browser's session, else ask. */
async function enter(token: string | null): Promise<Gate> {
  let notice: string | null = null;
  if (token !== null) {
    try {
      return { at: "inside", session: await login({ token }) };
    } catch (error) {
      const { title, remedy } = asApiError(error);
      notice = `${told(title)} ${told(remedy)}`;
    }
  }
  try {
    const session = await currentSession();
    return session === null ? { at: "login", notice } : { at: "inside", session };
  } catch (error) {
    const { title, remedy } = asApiError(error);
    return { at: "login", notice: notice ?? `${told(title)} ${told(remedy)}` };
  }
}

export function App({ token }: { token: string | null }) {
  const [gate, setGate] = useState<Gate>({ at: "opening" });
  useEffect(() => {
    void enter(token).then(setGate);
    // The printed address pasted into this very tab changes the fragment only: no page load.
    const onHash = () => {
      const pasted = takeToken();
      if (pasted !== null) void enter(pasted).then(setGate);
    };
    window.addEventListener("hashchange", onHash);
    return () => window.removeEventListener("hashchange", onHash);
  }, [token]);

  const onLogin = useCallback((session: Session) => setGate({ at: "inside", session }), []);
  const onLogout = useCallback(() => {
    const leave = (notice: string | null) => setGate({ at: "login", notice });
    logout().then(
      () => leave(null),
      (error: unknown) => leave(`${t("Logged out here only.")} ${told(asApiError(error).title)}`),
    );
  }, []);
  // The state socket was refused: either the console is away, or it no longer knows this session.
  const onRefused = useCallback(() => {
    currentSession().then(
      (session) => {
        if (session === null) {
          setGate({
            at: "login",
            notice: t(
              "Your session has ended: it was logged out, unused for long, or the console was started anew. Log in again.",
            ),
          });
        }
      },
      (error: unknown) => {
        if (!(error instanceof ApiError)) throw error; // away: the page says that its view is frozen
      },
    );
  }, []);

  switch (gate.at) {
    case "opening":
      return null;
    case "login":
      return (
        <>
          <LoginPage notice={gate.notice} onLogin={onLogin} />
          <OpenStop />
        </>
      );
    case "inside":
      return (
        <SessionContext value={{ session: gate.session, logout: onLogout }}>
          <WithStopLeft>
            <ConsolePage onRefused={onRefused} />
          </WithStopLeft>
        </SessionContext>
      );
  }
}
