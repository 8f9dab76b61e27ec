import createClient from "openapi-fetch";
import type { paths } from "../../generated/schema";
import { errorFromBody, noAnswer } from "./errors";

/** Requests to the console: paths, parameters, bodies and answers are checked against its schema. */
export const http = createClient<paths>({
  baseUrl: location.origin,
  credentials: "same-origin",
  cache: "no-store",
});

/** A signal that gives a request up after some time, or when the caller's own says so. */
export function within(ms: number, signal?: AbortSignal): AbortSignal {
  const timeout = AbortSignal.timeout(ms);
  return signal === undefined ? timeout : AbortSignal.any([signal, timeout]);
}

/** Time for an answer that needs no thought. */
export const QUICK_MS = 5000;

/** A change is on the robot's disk before it is answered, which the console awaits for 5 s. */
export const CHANGE_MS = 8000;

/**
 * An answer of the server. Its schema calls every field with a default optional; in an answer the
 * server sends them all.
 */
export type Sent<T> = T extends readonly (infer Item)[]
  ? Sent<Item>[]
  : T extends object
    ? { [Key in keyof T]-?: Sent<T[Key]> }
    : T;

/** The parameters of a query that have a value. */
export const given = <T extends object>(query: T) =>
  Object.fromEntries(Object.entries(query).filter(([, value]) => value !== null)) as {
    [Key in keyof T]?: Exclude<T[Key], null>;
  };

/**
 * What was answered to a request.
 *
 * @throws ApiError with the server's own words, or with status 0 when no answer came in time.
 * @throws DOMException "AbortError" when the caller's own signal was aborted.
 */
export async function answer<T>(
  request: Promise<{ data?: T; error?: unknown; response: Response }>,
): Promise<Sent<T>> {
  const { data, error, response } = await request.catch((failure: unknown) => {
    if (failure instanceof DOMException && failure.name === "AbortError") throw failure;
    throw noAnswer();
  });
  if (!response.ok) throw errorFromBody(response.status, error);
  return data as Sent<T>;
}
