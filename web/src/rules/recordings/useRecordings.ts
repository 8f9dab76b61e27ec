import { useQueryClient } from "@tanstack/react-query";
import { useCallback } from "react";
import { useAsked } from "../../api/queries";
import { listRecordings } from "../../api/recordingsClient";

/** The robot keeps recordings by itself, too: looked at again while the page is open. */
const AGAIN_MS = 5000;
const KEY = ["recordings"];

/** What is kept of the flight recorder, as long as somebody looks. */
export function useRecordings() {
  const client = useQueryClient();
  const { data: list, error } = useAsked({ key: KEY, ask: listRecordings, again: AGAIN_MS });
  const reload = useCallback(() => void client.invalidateQueries({ queryKey: KEY }), [client]);
  return { list, error, reload };
}
