import { CloseButton, UnstyledButton } from "@mantine/core";
import { useEffect, useRef } from "react";
import { LogPage } from "../log/LogPage";
import { useSession } from "../session/SessionContext";
import { english } from "../texts/language";
import { type Phrase, t } from "../texts/text";
import { TimelinePage } from "../timeline/TimelinePage";
import { AuditPage } from "./audit/AuditPage";
import { RulesBands } from "./bands/RulesBands";
import { type Place, SHEET_ID, useNav } from "./context/RulesNav";
import { RuleEditor } from "./editor/RuleEditor";
import { FiringsPage } from "./firings/FiringsPage";
import { HistoryPage } from "./history/HistoryPage";
import { RecordingsPage } from "./recordings/RecordingsPage";
import { ConflictPage } from "./review/ConflictPage";
import { ReviewPage } from "./review/ReviewPage";
import classes from "./Sheet.module.css";
import { RuleTable } from "./table/RuleTable";
import { WhyPage } from "./why/WhyPage";

interface Tab {
  label: Phrase;
  place: Place;
  holds: Place["at"][];
  /** Shown to engineers only. */
  engineer?: boolean;
}

const TABS: Tab[] = [
  { label: "Rules", place: { at: "table" }, holds: ["table", "edit", "why", "review", "conflict"] },
  { label: "Firings", place: { at: "firings", rule: null }, holds: ["firings"] },
  { label: "Timeline", place: { at: "timeline" }, holds: ["timeline"] },
  { label: "Log", place: { at: "log" }, holds: ["log"] },
  { label: "History", place: { at: "history", revision: null }, holds: ["history"] },
  { label: "Recordings", place: { at: "recordings", name: null }, holds: ["recordings"] },
  { label: "Audit", place: { at: "audit" }, holds: ["audit"], engineer: true },
];

/** The pages of rules are in English as a whole: so is what the robot says of them. */
const TRANSLATED: ReadonlySet<Place["at"]> = new Set(["timeline", "log", "firings"]);

/** The rules of the robot, beside the scene: what is in force, what is being written, what was. */
export function RulesSheet() {
  const nav = useNav();
  const { session } = useSession();
  const tabs = TABS.filter(({ engineer }) => !engineer || session.role === "engineer");
  const body = useRef<HTMLDivElement>(null);
  const { place, returnTo } = nav;

  // The button that led elsewhere is gone with its page, and the keyboard would begin anew at the
  // top of everything. Where somebody has put the focus meanwhile, it stays; and in the middle of a
  // press that takes it from one field to the next nobody has it yet, so that is waited for.
  useEffect(() => {
    const timer = window.setTimeout(() => {
      if (document.activeElement !== null && document.activeElement !== document.body) return;
      const from = returnTo === "" ? null : document.getElementById(returnTo);
      (from ?? (place.at === "table" ? null : body.current))?.focus();
    });
    return () => window.clearTimeout(timer);
  }, [place, returnTo]);

  return (
    <section
      className={classes.sheet}
      id={SHEET_ID}
      aria-label={t("Rules and timeline")}
      data-testid="rules-sheet"
    >
      <header className={classes.head}>
        <div className={classes.tabs}>
          {tabs.map(({ label, place: tab, holds }) => (
            <UnstyledButton
              key={label}
              className={classes.tab}
              aria-current={holds.includes(place.at) ? "page" : undefined}
              data-elsewhere={tab.at === "log" || undefined}
              data-testid={`rules-tab-${tab.at}`}
              onClick={() => nav.go(tab)}
            >
              {t(label)}
            </UnstyledButton>
          ))}
        </div>
        <CloseButton
          size="lg"
          aria-label={t("Close rules and timeline")}
          title={t("Close (Esc)")}
          data-testid="rules-close"
          onClick={nav.close}
        />
      </header>
      <div
        className={classes.body}
        key={place.at}
        ref={body}
        tabIndex={-1}
        lang={TRANSLATED.has(place.at) ? undefined : english()}
      >
        <Page place={place} />
      </div>
      {/* Below the page: what comes and goes above it would move it under somebody's hand. */}
      <div className={classes.bands}>
        <RulesBands />
      </div>
    </section>
  );
}

function Page({ place }: { place: Place }) {
  switch (place.at) {
    case "table":
      return <RuleTable />;
    case "edit":
      return <RuleEditor id={place.id} />;
    case "why":
      return (
        <WhyPage key={`${place.id} ${place.firing?.number}`} id={place.id} firing={place.firing} />
      );
    case "review":
      return <ReviewPage />;
    case "conflict":
      return <ConflictPage />;
    case "firings":
      return <FiringsPage rule={place.rule} />;
    case "timeline":
      return <TimelinePage />;
    case "log":
      return <LogPage />;
    case "history":
      return <HistoryPage revision={place.revision} />;
    case "recordings":
      return <RecordingsPage name={place.name} />;
    case "audit":
      return <AuditPage />;
  }
}
