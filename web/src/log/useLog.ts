import { useQueryClient } from "@tanstack/react-query";
import type { ApiError } from "../api/errors";
import { getLog, type LogQuery } from "../api/logClient";
import { useAsked } from "../api/queries";
import type { LogLine, LogPage, State } from "../api/types";
import { useRobot } from "../state/RobotContext";

/** So many lines are asked for at once. */
const ASKED = 200;
/** Between two questions, however fast the robot writes. */
const REST_MS = 700;

interface Log {
  lines: LogLine[] | null;
  nodes: string[];
  /** There are older ones that are not shown. */
  more: boolean;
  /** Lines of all kinds that have come and were not looked at yet. */
  waiting: number;
  fresh: boolean;
  error: ApiError | null;
}

/** The newest lines of the robot's log; read again while there are others, unless it is paused. */
export function useLog(query: LogQuery, most: number, paused = false): Log {
  const client = useQueryClient();
  const { state } = useRobot();
  const log = state?.log ?? null;
  const newest = log?.newest ?? null;
  const key = ["log", query, most];
  const { data, error, fresh } = useAsked<LogPage>({
    key,
    keep: true,
    again: (known) =>
      !paused && known !== undefined && log !== null && hasCome(log, query, known)
        ? REST_MS
        : false,
    ask: async (signal) => {
      const was = client.getQueryData<LogPage>(key);
      const page = await getLog(query, was?.newest ?? 0, Math.min(ASKED, most), signal);
      return joined(was, page, most);
    },
  });
  return {
    lines: data?.lines ?? null,
    nodes: data?.nodes ?? [],
    more: data?.more === true,
    waiting: data === null || newest === null ? 0 : Math.max(0, newest - data.newest),
    fresh,
    error,
  };
}

/** Whether there are lines to ask for: a robot that chats is asked for its warnings once it warns. */
export function hasCome(log: State["log"], { level }: LogQuery, known: LogPage): boolean {
  const loud = level === "warning" || level === "error" || level === "fatal";
  const restarted = log.newest < known.newest;
  return restarted || known.newest < (loud ? log.newest_warning : log.newest);
}

/** What was known and what has come since; where lines are missing between the two, the new alone. */
export function joined(was: LogPage | undefined, page: LogPage, most: number): LogPage {
  if (was === undefined || page.more || page.newest < was.newest) return page;
  const lines = [...page.lines, ...was.lines];
  return { ...page, lines: lines.slice(0, most), more: was.more || lines.length > most };
}
