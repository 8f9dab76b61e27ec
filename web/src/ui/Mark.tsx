/** The project's mark: a compass needle. */
export function Mark({ size }: { size: number }) {
  return (
    <svg width={size} height={size} viewBox="0 0 32 32" aria-hidden="true" focusable="false">
      <rect width="32" height="32" rx="7" fill="var(--accent-fill)" />
      <path d="M16 4 L21 16 L16 28 L11 16 Z" fill="#fff" />
      <path d="M16 4 L21 16 L11 16 Z" fill="#bcd4f7" />
    </svg>
  );
}
