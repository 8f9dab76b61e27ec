/** A failed request, told as a person needs it: what went wrong, and what to do. */
export class ApiError extends Error {
  override readonly name = "ApiError";

  constructor(
    /** HTTP status; 0 when no answer came, -1 where the page itself has failed. */
    readonly status: number,
    readonly title: string,
    readonly remedy: string,
    /** The whole answer, for those that say more than a sentence. */
    readonly body: unknown = null,
  ) {
    super(title);
  }
}

export function noAnswer(): ApiError {
  return new ApiError(
    0,
    "The console did not answer.",
    "Check the network between this browser and the robot, then try again.",
  );
}

/** Reads the `detail` of an error response; tolerates bodies that are not ours (a proxy's, say). */
export function errorFromBody(status: number, body: unknown): ApiError {
  const detail = isRecord(body) ? body.detail : undefined;
  if (isRecord(detail) && typeof detail.title === "string") {
    const remedy = detail.remedy;
    return new ApiError(status, detail.title, typeof remedy === "string" ? remedy : "", body);
  }
  if (typeof detail === "string") return new ApiError(status, detail, "");
  return new ApiError(
    status,
    `The console answered with error ${status}.`,
    "Reload the page; if it stays, look at the console's log on the robot.",
  );
}

/** A defect of the page itself: no answer of the console's is behind it. */
const failure = (error: unknown): ApiError =>
  new ApiError(-1, `This part of the page has failed: ${String(error)}.`, "Reload the page.");

/** Any thrown value as an ApiError, so that panels have one thing to show. */
export function asApiError(error: unknown): ApiError {
  if (error instanceof ApiError) return error;
  return error instanceof DOMException ? noAnswer() : failure(error);
}

export function isRecord(value: unknown): value is Record<string, unknown> {
  return typeof value === "object" && value !== null;
}
