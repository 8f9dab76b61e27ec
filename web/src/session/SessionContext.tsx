import { createContext, useContext } from "react";
import type { Session } from "../api/types";

export interface SessionValue {
  session: Session;
  logout: () => void;
}

export const SessionContext = createContext<SessionValue | null>(null);

export function useSession(): SessionValue {
  const value = useContext(SessionContext);
  if (value === null) throw new Error("useSession needs a logged-in page above it");
  return value;
}
