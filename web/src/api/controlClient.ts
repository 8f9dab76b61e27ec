import { answer, http, QUICK_MS, within } from "./http";

export const askForControl = () =>
  answer(http.POST("/api/control/ask", { signal: within(QUICK_MS) }));

/** Takes it from whoever has it, and says why. */
export const takeControl = (reason: string) =>
  answer(http.POST("/api/control/take", { body: { reason }, signal: within(QUICK_MS) }));

/** To who asks for it, or to nobody. */
export const giveControl = () =>
  answer(http.POST("/api/control/give", { signal: within(QUICK_MS) }));

export const keepControl = () =>
  answer(http.POST("/api/control/keep", { signal: within(QUICK_MS) }));
