import { useMutation, useQueryClient } from "@tanstack/react-query";
import { useEffect } from "react";
import {
  cancelDrill,
  type DrillOptions,
  getDrill,
  getDrillRoom,
  startDrill,
} from "../../api/drillsClient";
import type { Drill, DrillRoom } from "../../api/drillTypes";
import type { ApiError } from "../../api/errors";
import { useAsked } from "../../api/queries";
import type { Table } from "../../api/ruleTypes";
import { useRules } from "../context/RulesContext";

const POLL_MS = 500;
/** Somebody else, or a script, may begin one. */
export const ROOM_MS = 3000;
const ROOM = ["drills"];

export interface DrillHandle {
  /** Null until the console has told. */
  room: DrillRoom | null;
  /** The one that runs, or ran last; null when there is none to be shown. */
  drill: Drill | null;
  /** Whether it is of the table that is proposed now. */
  fresh: boolean;
  /** Whether somebody else began it, or a script, or this page before it was loaded again. */
  others: boolean;
  /** Whether it is being asked for. */
  starting: boolean;
  /** Why nothing was begun, or nothing is heard of it. */
  error: ApiError | null;
  start: (options: DrillOptions) => void;
  cancel: () => void;
}

/** What can be drilled, and the newest drill. Who has changed something is told before it is
 * reviewed, where it would otherwise move what is below it when it comes. */
export const useDrillRoom = (when: { enabled: boolean } | { again: number }) =>
  useAsked({ key: ROOM, ask: getDrillRoom, ...when });

/** One drill of the proposed table; it goes on when somebody looks elsewhere, and is found again. */
export function useDrill(table: Table): DrillHandle {
  const { drilled, setDrilled } = useRules();
  const client = useQueryClient();
  const { data: room, error: unknown } = useDrillRoom({ again: ROOM_MS });
  const begin = useMutation({
    mutationFn: (options: DrillOptions) => startDrill(table, options),
    onSuccess: ({ id }) => setDrilled({ id, of: table }),
    // Perhaps another's runs: then that is shown.
    onSettled: () => void client.invalidateQueries({ queryKey: ROOM }),
  });
  const found = room?.newest;
  const worthIt = found?.state === "running" || found?.state === "done";
  const id = drilled?.id ?? (worthIt ? found?.id : undefined);
  // One that begins is shown whoever began it: there is only one at a time.
  const begun = found?.state === "running" ? found.id : null;
  useEffect(() => {
    if (begun !== null) setDrilled((was) => (was?.id === begun ? was : { id: begun, of: null }));
  }, [begun, setDrilled]);
  const { data: drill, error: lost } = useAsked({
    key: ["drill", id],
    enabled: id !== undefined,
    ask: (signal) => getDrill(id ?? "", signal),
    again: (newest, failure) =>
      failure !== null || (newest !== undefined && newest.state !== "running") ? false : POLL_MS,
  });
  const others = (drilled?.of ?? null) === null;
  const cancel = useMutation({
    mutationFn: cancelDrill,
    onSettled: () => void client.invalidateQueries({ queryKey: ["drill", id] }),
  });
  return {
    room,
    drill,
    // Of a drill that somebody else began the table is not known here.
    fresh: others || drilled?.of === table,
    others,
    starting: begin.isPending,
    error: begin.error ?? cancel.error ?? lost ?? unknown,
    start: (options) => {
      cancel.reset();
      begin.mutate(options);
    },
    cancel: () => {
      if (id !== undefined) cancel.mutate(id);
    },
  };
}
