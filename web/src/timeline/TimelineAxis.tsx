import { type CSSProperties, type KeyboardEvent, type PointerEvent, useRef, useState } from "react";
import type { TimelineKind, TimelineLevel, TimelineSlot } from "../api/types";
import { clockText, dateText } from "../texts/dates";
import { t } from "../texts/text";
import { drawn, type Ends, type Span, ticksOf } from "./span";
import classes from "./Timeline.module.css";
import { KINDS, markOf } from "./timelineText";

const LANE = 16;
const MARKS = 6;

interface Props {
  ends: Ends;
  slots: readonly TimelineSlot[];
  count: number;
  now: number;
  /** Leaves out lanes on which there is nothing: there is no height for them. */
  brief: boolean;
  /** The kinds that are shown; others are dimmed out. */
  kinds: ReadonlySet<TimelineKind>;
  onKind: (kind: TimelineKind) => void;
  onSpan: (span: Span) => void;
  onKey: (key: "earlier" | "later" | "closer" | "wider") => void;
}

const RANK: Record<TimelineLevel, number> = { info: 0, warning: 1, error: 2, critical: 3 };

/** What happened, a lane for each kind: the more, the darker; the worse, the higher and redder. */
export function TimelineAxis(props: Props) {
  const { ends, slots, count, now, brief, kinds, onKind, onSpan, onKey } = props;
  const plot = useRef<HTMLDivElement>(null);
  const [drag, setDrag] = useState<[number, number] | null>(null);
  const length = ends.until - ends.since;
  const partOf = (event: PointerEvent) => {
    const box = plot.current?.getBoundingClientRect();
    return box === undefined ? 0 : (event.clientX - box.left) / box.width;
  };
  const release = (event: PointerEvent) => {
    if (drag === null) return;
    const span = drawn(ends, drag[0], partOf(event));
    setDrag(null);
    if (span !== null) onSpan(span);
  };
  const onKeyDown = (event: KeyboardEvent) => {
    const does = {
      ArrowLeft: "earlier",
      ArrowRight: "later",
      "+": "closer",
      "-": "wider",
    } as const;
    const what = does[event.key as keyof typeof does];
    if (what === undefined) return;
    event.preventDefault();
    event.stopPropagation();
    onKey(what);
  };
  const most = new Map<TimelineKind, number>();
  for (const { kind, count: each } of slots) most.set(kind, Math.max(most.get(kind) ?? 1, each));
  const lanes = brief ? KINDS.filter(({ kind }) => most.has(kind) || !kinds.has(kind)) : KINDS;
  const lane = new Map(lanes.map(({ kind }, index) => [kind, index]));
  const days = length > 2 * 86400;
  // At the very end there is no room for the words.
  const ticks = ticksOf(ends, MARKS).filter((at) => at - ends.since < 0.92 * length);
  return (
    <div className={classes.axis} style={{ "--lanes": Math.max(1, lanes.length) } as CSSProperties}>
      <div className={classes.lanes}>
        {lanes.map(({ kind, label }) => (
          <button
            key={kind}
            type="button"
            className={classes.lane}
            aria-pressed={kinds.has(kind)}
            data-testid={`timeline-kind-${kind}`}
            onClick={() => onKind(kind)}
          >
            {t(label)}
          </button>
        ))}
      </div>
      {/* biome-ignore lint/a11y/useSemanticElements: a picture that is moved by hand and by keys */}
      <div
        ref={plot}
        className={classes.plot}
        role="group"
        // biome-ignore lint/a11y/noNoninteractiveTabindex: the keys move it
        tabIndex={0}
        aria-label={t(
          "What happened from {since} to {until}: arrows go earlier and later, plus and minus closer and wider",
          { since: dateText(ends.since), until: dateText(ends.until) },
        )}
        data-testid="timeline-plot"
        onKeyDown={onKeyDown}
        onPointerDown={(event) => {
          if (event.button !== 0) return;
          event.currentTarget.setPointerCapture(event.pointerId);
          const at = partOf(event);
          setDrag([at, at]);
        }}
        onPointerMove={(event) => drag !== null && setDrag([drag[0], partOf(event)])}
        onPointerUp={release}
        onPointerCancel={() => setDrag(null)}
      >
        <svg
          className={classes.marks}
          viewBox={`0 0 ${count} ${Math.max(1, lanes.length) * LANE}`}
          preserveAspectRatio="none"
          aria-hidden="true"
        >
          {slots.map(({ kind, slot, count: each, level }) => {
            const top = (lane.get(kind) ?? 0) * LANE;
            const high = level === "info" ? 0.5 : level === "warning" ? 0.75 : 1;
            const tall = (LANE - 4) * high;
            return (
              <rect
                key={`${kind} ${slot}`}
                x={slot + 0.08}
                width={0.84}
                y={top + (LANE - 2 - tall)}
                height={tall}
                fill={RANK[level] === 0 ? "var(--accent)" : `var(--${markOf(level)})`}
                opacity={
                  (kinds.has(kind) ? 1 : 0.25) * (0.45 + 0.55 * (each / (most.get(kind) ?? 1)))
                }
              />
            );
          })}
        </svg>
        {drag !== null && (
          <div
            className={classes.brush}
            style={{
              left: `${100 * Math.max(0, Math.min(drag[0], drag[1]))}%`,
              right: `${100 * Math.max(0, 1 - Math.max(drag[0], drag[1]))}%`,
            }}
          />
        )}
        {now <= ends.until && now >= ends.since && (
          <div
            className={classes.now}
            style={{ left: `${(100 * (now - ends.since)) / length}%` }}
          />
        )}
        <div className={classes.ticks} aria-hidden="true">
          {ticks.map((at) => (
            <span key={at} style={{ left: `${(100 * (at - ends.since)) / length}%` }}>
              {days ? dateText(at, "day") : length < 120 ? clockText(at) : dateText(at, "minute")}
            </span>
          ))}
        </div>
      </div>
    </div>
  );
}
