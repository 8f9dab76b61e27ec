/** What a line of the audit log says beside its columns: `3 → 4 · reason: tidy up`. */
export function detailsText(details: Record<string, unknown>): string {
  const { before, after, ...more } = details;
  const change = changeText(before, after);
  const said = Object.entries(more)
    .filter(([, value]) => isSaid(value))
    .map(([key, value]) => `${key.replaceAll("_", " ")}: ${valueText(value)}`);
  return [...(change === "" ? [] : [change]), ...said].join(" · ");
}

function changeText(before: unknown, after: unknown): string {
  if (isSaid(before) && isSaid(after)) return `${valueText(before)} → ${valueText(after)}`;
  if (isSaid(before)) return `before: ${valueText(before)}`;
  return isSaid(after) ? `after: ${valueText(after)}` : "";
}

function isSaid(value: unknown): boolean {
  return (
    value !== undefined && value !== null && value !== "" && value !== false && !isEmpty(value)
  );
}

function valueText(value: unknown): string {
  if (Array.isArray(value)) return value.map(valueText).join(", ");
  if (typeof value === "object" && value !== null) {
    const inner = Object.entries(value)
      .filter(([, each]) => isSaid(each))
      .map(([key, each]) => `${key.replaceAll("_", " ")} ${valueText(each)}`);
    return inner.length === 0 ? "none" : inner.join(", ");
  }
  if (typeof value === "number") return String(Math.round(value * 1000) / 1000);
  return String(value);
}

function isEmpty(value: unknown): boolean {
  return Array.isArray(value) && value.length === 0;
}

/** Whether what was tried was not done. */
export const failed = (outcome: string): boolean =>
  /^(refused|failed|wrong token|no drive manager|lines? |\d+ lines are lost)/.test(outcome);
