/** Shape of a verdict: a tick, a cross or a question; the word stands beside it. */
export function VerdictMark({ verdict }: { verdict: boolean | null }) {
  return (
    <svg
      width={12}
      height={12}
      viewBox="0 0 12 12"
      aria-hidden="true"
      focusable="false"
      fill="none"
      stroke="currentColor"
      strokeWidth="2"
      strokeLinecap="round"
      strokeLinejoin="round"
      style={{ flex: "none", color: verdict === null ? "var(--unknown)" : "currentColor" }}
    >
      {verdict === true && <path d="M1.5 6.5 L4.5 9.5 L10.5 2.5" />}
      {verdict === false && <path d="M2 2 L10 10 M10 2 L2 10" />}
      {verdict === null && <circle cx="6" cy="6" r="4" strokeDasharray="2.5 2.5" />}
    </svg>
  );
}

export function verdictWord(verdict: boolean | null): string {
  return verdict === null ? "unknown" : String(verdict);
}
