import { Button, SegmentedControl, TextInput } from "@mantine/core";
import { useDebouncedValue, useMediaQuery } from "@mantine/hooks";
import {
  IconChevronLeft,
  IconChevronRight,
  IconDownload,
  IconZoomIn,
  IconZoomOut,
} from "@tabler/icons-react";
import { useMutation } from "@tanstack/react-query";
import { useMemo, useState } from "react";
import { getFirings } from "../api/rulesClient";
import { timelineExport } from "../api/timelineClient";
import type { TimelineEntry, TimelineKind, TimelineLevel } from "../api/types";
import { useNav } from "../rules/context/RulesNav";
import { Day } from "../rules/parts/Day";
import { useSession } from "../session/SessionContext";
import { useNow, useRobot } from "../state/RobotContext";
import { type Phrase, t } from "../texts/text";
import { told } from "../texts/told";
import { Choice } from "../ui/controls/Choice";
import { IconButton } from "../ui/controls/IconButton";
import { Problem } from "../ui/Problem";
import page from "../ui/page.module.css";
import { PHONE } from "../ui/screen";
import { NoteForm } from "./NoteForm";
import { endsOf, HOURS, moved, type Span, zoomed } from "./span";
import classes from "./Timeline.module.css";
import { TimelineAxis } from "./TimelineAxis";
import { TimelineRow } from "./TimelineRow";
import { KINDS } from "./timelineText";
import { useTimeline } from "./useTimeline";

const LEVELS: { value: string; label: Phrase }[] = [
  { value: "info", label: "everything" },
  { value: "warning", label: "warnings and worse" },
  { value: "error", label: "errors only" },
];
/** Firings of one rule that are looked through for the one that is meant. */
const LOOKED_THROUGH = 500;

/** What has happened to the robot: faults, stops, goals, edits, people, on one axis. */
export function TimelinePage() {
  const { session } = useSession();
  const { state } = useRobot();
  const phone = useMediaQuery(PHONE, false, { getInitialValueInEffect: false });
  const now = useNow();
  const [span, setSpan] = useState<Span>({ hours: 1 });
  const [hidden, setHidden] = useState<ReadonlySet<TimelineKind>>(new Set());
  const [level, setLevel] = useState<TimelineLevel>("info");
  const [typed, setTyped] = useState("");
  const [text] = useDebouncedValue(typed.trim(), 300);
  const slots = phone ? 60 : 120;
  const ends = endsOf(span, now, slots);
  const kinds = useMemo(
    () => KINDS.map(({ kind }) => kind).filter((kind) => !hidden.has(kind)),
    [hidden],
  );
  const found = useTimeline(
    { kinds: hidden.size === 0 ? [] : kinds, level, text, ...ends },
    kinds.length === 0 ? 0 : slots,
  );
  const components = state?.components ?? [];
  const labels = new Map(components.map(({ name, label }) => [name, told(label)]));
  const open = useOpen();
  const entries = kinds.length === 0 ? [] : (found.page?.entries ?? []);
  const toggle = (kind: TimelineKind) => {
    const next = new Set(hidden);
    if (!next.delete(kind)) next.add(kind);
    setHidden(next);
  };
  const go = {
    earlier: () => setSpan(moved(ends, -0.5, now)),
    later: () => setSpan(moved(ends, 0.5, now)),
    closer: () => setSpan(zoomed(span, ends, 0.5, now)),
    wider: () => setSpan(zoomed(span, ends, 2, now)),
  };
  const live = "hours" in span;
  return (
    <div className={page.page} data-testid="timeline">
      <div className={classes.tools}>
        <SegmentedControl
          size="sm"
          className={classes.back}
          aria-label={t("How far back")}
          data={HOURS.map(({ hours, label }) => ({ value: String(hours), label: t(label) }))}
          value={live ? String(span.hours) : ""}
          onChange={(hours) => setSpan({ hours: Number(hours) })}
        />
        <span className={classes.moves}>
          <IconButton label={t("Earlier")} onClick={go.earlier} Icon={IconChevronLeft} />
          <IconButton label={t("Closer")} onClick={go.closer} Icon={IconZoomIn} />
          <IconButton label={t("Wider")} onClick={go.wider} Icon={IconZoomOut} />
          <IconButton
            label={t("Later")}
            disabled={live}
            onClick={go.later}
            Icon={IconChevronRight}
          />
        </span>
      </div>
      <TimelineAxis
        ends={ends}
        slots={found.page?.slots ?? []}
        count={slots}
        now={now}
        brief={phone}
        kinds={new Set(kinds)}
        onKind={toggle}
        onSpan={setSpan}
        onKey={(what) => go[what]()}
      />
      <div className={classes.tools}>
        <TextInput
          size="sm"
          className={classes.grow}
          aria-label={t("Only what has these words")}
          placeholder={t("only with …")}
          maxLength={200}
          value={typed}
          data-testid="timeline-text"
          onChange={(event) => setTyped(event.currentTarget.value)}
        />
        <Choice
          aria-label={t("How bad at least")}
          className={classes.level}
          data={LEVELS.map(({ value, label }) => ({ value, label: t(label) }))}
          value={level}
          onChange={(value) => setLevel(value as TimelineLevel)}
        />
        <Button
          component="a"
          variant="default"
          size="sm"
          leftSection={<IconDownload size={16} aria-hidden />}
          href={timelineExport(ends.since, ends.until)}
          download
          data-testid="timeline-export"
        >
          {t("Export")}
        </Button>
      </div>
      {session.role !== "viewer" && <NoteForm />}
      <Problem error={found.error ?? open.error} />
      {found.page !== null && found.page.problem !== "" && (
        <p className={page.problem} role="status">
          {told(found.page.problem)}
        </p>
      )}
      {found.page === null && found.error === null && (
        <p className={page.muted}>{t("Reading the timeline…")}</p>
      )}
      {found.page !== null && entries.length === 0 && (
        <p className={page.empty}>
          {hidden.size > 0 || level !== "info" || text !== ""
            ? t("Nothing like that in this time.")
            : t("Nothing happened in this time.")}
        </p>
      )}
      <ul
        className={classes.list}
        aria-label={t("What happened")}
        data-stale={!found.fresh || undefined}
      >
        {entries.map((entry, index) => (
          <li key={entry.number}>
            <Day time={entry.time} newer={entries[index - 1]?.time ?? now} />
            <TimelineRow entry={entry} labels={labels} now={now} onOpen={open.of(entry)} />
          </li>
        ))}
      </ul>
      {found.page?.more === true && entries.length > 0 && (
        <Button
          variant="default"
          loading={found.older.pending}
          data-testid="timeline-older"
          onClick={found.older.ask}
        >
          {t("Older")}
        </Button>
      )}
    </div>
  );
}

/** Leads from an entry to where more is told: the Why of a firing, a revision, an audit log. */
function useOpen() {
  const nav = useNav();
  const firing = useMutation({
    mutationFn: async ({ rule, run, epoch }: { rule: string; run: number; epoch: string }) => {
      const { firings } = await getFirings(null, LOOKED_THROUGH, rule);
      const meant = firings.find((each) => each.run_id === run && each.epoch === epoch);
      if (meant === undefined) nav.go({ at: "firings", rule });
      else nav.go({ at: "why", id: rule, firing: meant });
    },
  });
  const of = ({ kind, link }: TimelineEntry): (() => void) | null => {
    if (link?.at === "firing") return () => firing.mutate(link);
    if (link?.at === "revision") return () => nav.go({ at: "history", revision: link.number });
    return kind === "rule" ? () => nav.go({ at: "firings", rule: null }) : null;
  };
  return { of, error: firing.error };
}
