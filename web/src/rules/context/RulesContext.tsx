import {
  createContext,
  type ReactNode,
  useCallback,
  useContext,
  useEffect,
  useMemo,
  useState,
} from "react";
import { type ApiError, asApiError } from "../../api/errors";
import { getGraph, getRules } from "../../api/rulesClient";
import type { Graph, TableView } from "../../api/ruleTypes";
import { useSession } from "../../session/SessionContext";
import { type Check, useCheck } from "./useCheck";
import { type DraftHandle, useDraft } from "./useDraft";
import { type LiveRules, useLiveRules } from "./useLiveRules";

export interface Rules {
  view: TableView | null;
  graph: Graph | null;
  /** Why there is no newer table; null when there is nothing to complain about. */
  error: ApiError | null;
  draft: DraftHandle;
  check: Check;
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
  const [view, setView] = useState<TableView | null>(null);
  const [graph, setGraph] = useState<Graph | null>(null);
  const [error, setError] = useState<ApiError | null>(null);
  const [asked, setAsked] = useState(0);
  const revision = live.rules?.available ? live.rules.revision : null;
  const confirmed = live.rules?.confirmed ?? null;
  const { connected } = live;

  // biome-ignore lint/correctness/useExhaustiveDependencies: each of them is a reason to ask again
  useEffect(() => {
    if (!connected || revision === null) return;
    let left = false;
    getRules().then(
      (answer) => {
        if (left) return;
        setView(answer);
        setError(null);
      },
      (failure: unknown) => {
        if (!left) setError(asApiError(failure));
      },
    );
    return () => {
      left = true;
    };
  }, [revision, confirmed, connected, asked]);

  const reload = useCallback(() => setAsked((count) => count + 1), []);
  const reloadGraph = useCallback(() => {
    getGraph().then(setGraph, (failure: unknown) => setError(asApiError(failure)));
  }, []);
  useEffect(() => {
    if (revision !== null) reloadGraph();
  }, [revision, reloadGraph]);

  const draft = useDraft(view);
  const check = useCheck(draft.draft, view);
  const value = useMemo<Rules>(
    () => ({
      view,
      graph,
      error,
      draft,
      check,
      mayEdit: session.role !== "viewer",
      mayProtect: session.role === "engineer",
      reload,
      reloadGraph,
    }),
    [view, graph, error, draft, check, session.role, reload, reloadGraph],
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
