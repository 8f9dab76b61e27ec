/** What a line of the audit log says beside its columns: `reason: tidy up · before: 3 · after: 4`. */
export function detailsText(details: Record<string, unknown>): string {
  return Object.entries(details)
    .filter(([, value]) => value !== null && value !== "" && value !== false && !isEmpty(value))
    .map(([key, value]) => `${key.replaceAll("_", " ")}: ${valueText(value)}`)
    .join(" · ");
}

function valueText(value: unknown): string {
  if (Array.isArray(value)) return value.map(valueText).join(", ");
  if (typeof value === "object" && value !== null) {
    const inner = detailsText(value as Record<string, unknown>);
    return inner === "" ? "none" : `(${inner})`;
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
