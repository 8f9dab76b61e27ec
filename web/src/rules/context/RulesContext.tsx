import { useQueryClient } from "@tanstack/react-query";
import {
  createContext,
  type Dispatch,
  type ReactNode,
  type SetStateAction,
  useCallback,
  useContext,
  useEffect,
  useMemo,
  useState,
} from "react";
import type { ApiError } from "../../api/errors";
import { useAsked } from "../../api/queries";
import { getGraph, getRules } from "../../api/rulesClient";
import type { Graph, Table, TableView } from "../../api/ruleTypes";
import { useSession } from "../../session/SessionContext";
import { type DrillWish, keepWish, keptWish } from "../drill/wish";
import { type Check, useCheck } from "./useCheck";
import { type DraftHandle, useDraft } from "./useDraft";
import { type LiveRules, useLiveRules } from "./useLiveRules";

interface Drilled {
  id: string;
  /** Null where somebody else began it. */
  of: Table | null;
}

interface Played {
  drill: string;
  scenario: string;
}

export interface Rules {
  view: TableView | null;
  graph: Graph | null;
  /** Why there is no newer table; null when there is nothing to complain about. */
  error: ApiError | null;
  draft: DraftHandle;
  check: Check;
  /** The drill that was last begun, here or by somebody else, and of which table. */
  drilled: Drilled | null;
  setDrilled: Dispatch<SetStateAction<Drilled | null>>;
  /** The drive that is looked at; it stays open where the page is laid out anew. */
  played: Played | null;
  setPlayed: Dispatch<SetStateAction<Played | null>>;
  /** What a person wants to be drilled on this page; it stays while they look elsewhere. */
  wish: DrillWish;
  setWish: Dispatch<SetStateAction<DrillWish>>;
  mayEdit: boolean;
  mayProtect: boolean;
  reload: () => void;
  /** Looks again at what is on the robot's graph. */
  reloadGraph: () => void;
}

const RulesContext = createContext<Rules | null>(null);
const LiveContext = createContext<LiveRules | null>(null);

/** The rule table for the page: the one in force, the draft of the next, and how it is doing. */
export function RulesProvider({ children }: { children: ReactNode }) {
  const { session } = useSession();
  const live = useLiveRules();
  const revision = live.rules?.available ? live.rules.revision : null;
  const confirmed = live.rules?.confirmed ?? null;
  const client = useQueryClient();
  const { data: view, error: unread } = useAsked({
    key: ["rules", revision, confirmed],
    ask: getRules,
    enabled: live.connected && revision !== null,
    keep: true,
  });
  const { data: graph, error: unseen } = useAsked({
    key: ["graph", revision],
    ask: getGraph,
    enabled: revision !== null,
    keep: true,
  });
  const error = unread ?? unseen;
  const reloadGraph = useCallback(
    () => void client.invalidateQueries({ queryKey: ["graph"] }),
    [client],
  );
  const reload = useCallback(() => {
    void client.invalidateQueries({ queryKey: ["rules"] });
    reloadGraph();
  }, [client, reloadGraph]);

  const draft = useDraft(view);
  const [drilled, setDrilled] = useState<Drilled | null>(null);
  const [played, setPlayed] = useState<Played | null>(null);
  const [wish, setWish] = useState(keptWish);
  useEffect(() => keepWish(wish), [wish]);
  const check = useCheck(draft.draft, view);
  const value = useMemo<Rules>(
    () => ({
      view,
      graph,
      error,
      draft,
      check,
      drilled,
      setDrilled,
      played,
      setPlayed,
      wish,
      setWish,
      mayEdit: session.role !== "viewer",
      mayProtect: session.role === "engineer",
      reload,
      reloadGraph,
    }),
    [view, graph, error, draft, check, drilled, played, wish, session.role, reload, reloadGraph],
  );
  return (
    <RulesContext value={value}>
      <LiveContext value={live}>{children}</LiveContext>
    </RulesContext>
  );
}

export function useRules(): Rules {
  const rules = useContext(RulesContext);
  if (rules === null) throw new Error("useRules needs a RulesProvider above it");
  return rules;
}

/** Re-renders its component a few times a second: leaves only. */
export function useLive(): LiveRules {
  const live = useContext(LiveContext);
  if (live === null) throw new Error("useLive needs a RulesProvider above it");
  return live;
}
