/** How bad it is, from calm to loud; `unknown` is silence, which is neither well nor failed. */
export type Level = "healthy" | "degraded" | "failed" | "unknown";

/** Shape and colour of a level; the word always stands beside it. */
export function StatusMark({ level, size = 12 }: { level: Level; size?: number }) {
  return (
    <svg
      width={size}
      height={size}
      viewBox="0 0 12 12"
      aria-hidden="true"
      focusable="false"
      style={{ flex: "none", color: `var(--${level})` }}
    >
      {level === "healthy" && <circle cx="6" cy="6" r="4.5" fill="currentColor" />}
      {level === "degraded" && <path d="M6 0.8 L11.6 11 L0.4 11 Z" fill="currentColor" />}
      {level === "failed" && <rect x="1" y="1" width="10" height="10" fill="currentColor" />}
      {level === "unknown" && (
        <circle cx="6" cy="6" r="4.2" fill="none" stroke="currentColor" strokeWidth="2" />
      )}
    </svg>
  );
}
