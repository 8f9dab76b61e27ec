import { useCallback, useEffect, useMemo, useRef, useState } from "react";
import type { RuleChange, Table, TableView } from "../../api/ruleTypes";
import {
  beginDraft,
  changesOf,
  type Draft,
  discardRule,
  isEmpty,
  keepDraft,
  keptDraft,
  settle,
} from "../changes/draft";

export interface DraftHandle {
  draft: Draft | null;
  changes: RuleChange[];
  /** The draft's table, or the one in force when there is no draft. */
  table: Table | null;
  /** Whether the table in force is no longer the one from which the edits began. */
  overtaken: boolean;
  /** False when this browser cannot keep the draft over a reload. */
  kept: boolean;
  edit: (change: (table: Table) => Table) => void;
  say: (reason: string) => void;
  discard: (id: string) => void;
  discardAll: () => void;
  undo: (() => void) | null;
  /** Goes on with another draft (after a merge), or with none (after an apply). */
  take: (draft: Draft | null) => void;
}

const MOST_UNDOS = 50;
const EMPTY: RuleChange[] = [];

/** The edits that the robot has not seen yet: kept in this browser until they are applied. */
export function useDraft(view: TableView | null): DraftHandle {
  const [draft, setDraft] = useState<Draft | null>(null);
  const [past, setPast] = useState<(Draft | null)[]>([]);
  const [kept, setKept] = useState(true);
  const loaded = useRef<string | null>(null);
  // Two changes may come before the page is drawn again; neither may undo the other.
  const latest = useRef<Draft | null>(null);

  const put = useCallback((robot: string, next: Draft | null) => {
    latest.current = next;
    setDraft(next);
    try {
      keepDraft(window.localStorage, robot, next);
      setKept(true);
    } catch {
      setKept(false); // no room, or storage is switched off: the page says so
    }
  }, []);

  useEffect(() => {
    if (view === null) return;
    const first = loaded.current !== view.robot;
    loaded.current = view.robot;
    let mine = latest.current;
    if (first) {
      try {
        mine = keptDraft(window.localStorage, view.robot);
      } catch {
        setKept(false);
      }
    }
    const settled = mine === null ? null : settle(mine, view.table, view.revision);
    if (settled !== latest.current) put(view.robot, settled);
  }, [view, put]);

  const change = useCallback(
    (make: (draft: Draft) => Draft) => {
      if (view === null) return;
      const before = latest.current;
      const next = make(before ?? beginDraft(view.robot, view.revision, view.table));
      setPast((all) => [...all.slice(-MOST_UNDOS), before]);
      put(view.robot, isEmpty(next) && next.base === view.revision ? null : next);
    },
    [view, put],
  );

  const changes = useMemo(() => (draft === null ? EMPTY : changesOf(draft)), [draft]);
  const undo = useCallback(() => {
    const before = past.at(-1);
    if (before === undefined || view === null) return;
    setPast(past.slice(0, -1));
    put(view.robot, before);
  }, [past, view, put]);

  return useMemo(
    () => ({
      draft,
      changes,
      table: draft?.table ?? view?.table ?? null,
      overtaken: draft !== null && view !== null && draft.base !== view.revision,
      kept,
      edit: (make) => change((from) => ({ ...from, table: make(from.table) })),
      say: (reason) => {
        const from = latest.current;
        if (from !== null) put(from.robot, { ...from, reason });
      },
      discard: (id) => change((from) => discardRule(from, id)),
      discardAll: () => {
        setPast((all) => [...all.slice(-MOST_UNDOS), draft]);
        if (view !== null) put(view.robot, null);
      },
      undo: past.length > 0 ? undo : null,
      take: (next) => {
        setPast([]);
        if (view !== null) put(view.robot, next);
      },
    }),
    [draft, changes, view, kept, change, put, past, undo],
  );
}
