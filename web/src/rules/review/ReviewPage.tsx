import { Button, Radio, Textarea } from "@mantine/core";
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { useEffect, useState } from "react";
import { applyRules, conflictOf, reportOf } from "../../api/rulesClient";
import type { ApplyReport, Finding, Table } from "../../api/ruleTypes";
import { Choice } from "../../ui/controls/Choice";
import { Problem } from "../../ui/Problem";
import page from "../../ui/page.module.css";
import type { Draft } from "../changes/draft";
import { useRules } from "../context/RulesContext";
import { useNav } from "../context/RulesNav";
import { CHECK } from "../context/useCheck";
import { DrillPanel } from "../drill/DrillPanel";
import { NewestDrill } from "../drill/NewestDrill";
import { useDrillRoom } from "../drill/useDrill";
import { ruleName } from "../model/words";
import { DiffList } from "../parts/DiffList";
import { FindingList } from "../parts/FindingList";
import { PageTitle } from "../parts/PageTitle";
import { Applied } from "./Applied";
import { BacktestPanel } from "./BacktestPanel";
import { EffectView } from "./EffectView";
import classes from "./Review.module.css";
import { ActsAtOnce, TrueNow } from "./TrueNow";

/** What will change, what it would have done, and the button that does it. */
export function ReviewPage() {
  const { draft } = useRules();
  const nav = useNav();
  const [applied, setApplied] = useState<Result | null>(null);
  return (
    <div className={page.page} data-testid="review">
      <PageTitle
        title={applied !== null ? "Applied" : draft.draft === null ? "Review" : "Review & apply"}
        back="Rules"
        onBack={() => nav.go({ at: "table" })}
      />
      {applied !== null ? (
        <Applied {...applied} />
      ) : draft.draft === null ? (
        <>
          <p className={page.muted}>There is nothing to apply.</p>
          <NewestDrill />
        </>
      ) : (
        <Review draft={draft.draft} onApplied={setApplied} />
      )}
    </div>
  );
}

const AGAIN_MS = 2000;
const PROBATIONS = [
  { value: "60", label: "60 s on probation, then back unless kept" },
  { value: "300", label: "5 min on probation" },
  { value: "1800", label: "30 min on probation" },
  { value: "0", label: "no probation: it stays" },
];

/** What was applied; the rules may be gone by the time it is read. */
interface Result {
  report: ApplyReport;
  rules: Table["rules"];
}

interface Props {
  draft: Draft;
  onApplied: (result: Result) => void;
}

function Review({ draft, onApplied }: Props) {
  const { draft: handle, check, reload } = useRules();
  const nav = useNav();
  const [probation, setProbation] = useState("60");
  const [cancelRunning, setCancelRunning] = useState(false);
  const report = check.report;
  const drilling = useDrillRoom({ enabled: true }).data?.newest?.state === "running";
  useAskedAgain();
  const names = new Map(
    [...draft.baseTable.rules, ...draft.table.rules].map((rule) => [rule.id, ruleName(rule)]),
  );
  const errors = check.findings.filter((finding) => finding.level === "error");
  // What is true now stands above it all, with when it fires.
  const lints = check.findings.filter(
    (finding) => finding.level === "lint" && finding.code !== "true-now",
  );
  const running = report?.effect.running ?? [];

  const apply = useMutation({
    mutationFn: () =>
      applyRules(draft.table, {
        expectedRevision: draft.base,
        reason: draft.reason,
        probation: Number(probation),
        cancelRunning,
      }),
    onSuccess: (answer) => {
      // The page may be gone by now; the draft has done its work all the same.
      handle.take(null);
      onApplied({ report: answer, rules: [...draft.table.rules, ...draft.baseTable.rules] });
      reload();
    },
    onError: (failure) => {
      if (conflictOf(failure) === null) return;
      reload();
      nav.go({ at: "conflict" });
    },
  });
  const refused = reportOf(apply.error)?.findings.filter(({ level }) => level === "error") ?? [];

  return (
    <>
      {report !== null && <TrueNow report={report} />}
      <section className={page.section} aria-label="Changes">
        <DiffList
          changes={report?.diff.changes ?? handle.changes}
          rules={[...draft.table.rules, ...draft.baseTable.rules]}
        />
        {report !== null && <EffectView effect={report.effect} names={names} />}
        {report === null && check.error === null && errors.length === 0 && (
          <p className={page.muted}>Asking the robot what it makes of it…</p>
        )}
        <Problem error={check.error} />
      </section>
      {errors.length > 0 && <Findings title="To be mended first" findings={errors} names={names} />}
      {lints.length > 0 && <Findings title="To think about" findings={lints} names={names} />}
      <BacktestPanel table={draft.table} names={names} ready={check.ok} />
      <DrillPanel table={draft.table} ready={check.ok} />
      <section className={page.section} aria-label="Apply">
        <Textarea
          label="Reason"
          placeholder="Why, for who reads the history"
          size="sm"
          autosize
          minRows={1}
          maxRows={4}
          value={draft.reason}
          data-testid="apply-reason"
          onChange={(event) => handle.say(event.currentTarget.value)}
        />
        {running.length > 0 && (
          <Radio.Group
            size="sm"
            label={`Running right now: ${running.map((id) => names.get(id) ?? id).join(", ")}`}
            value={cancelRunning ? "cancel" : "finish"}
            onChange={(choice) => setCancelRunning(choice === "cancel")}
          >
            <Radio value="finish" label="let their actions finish" mt={4} />
            <Radio value="cancel" label="cancel their actions" mt={4} />
          </Radio.Group>
        )}
        {report !== null && <ActsAtOnce prospects={report.prospects} names={names} />}
        <div className={classes.apply}>
          <Choice
            aria-label="Probation"
            data={PROBATIONS}
            value={probation}
            data-testid="apply-probation"
            onChange={setProbation}
          />
          <Button
            loading={apply.isPending}
            disabled={!check.ok || handle.overtaken}
            onClick={() => apply.mutate()}
            data-testid="apply"
          >
            Apply to the robot
          </Button>
        </div>
        {drilling && (
          <p className={page.note} data-testid="apply-ends-drill">
            A drill runs, of what is in force now: Apply ends it.
          </p>
        )}
        <Problem error={apply.error} testId="apply-error" />
        <FindingList findings={refused} />
      </section>
    </>
  );
}

/** The robot goes on while somebody reads: what is true now is asked again and again. */
function useAskedAgain() {
  const client = useQueryClient();
  useEffect(() => {
    const again = () => void client.invalidateQueries({ queryKey: CHECK });
    const timer = window.setInterval(again, AGAIN_MS);
    return () => window.clearInterval(timer);
  }, [client]);
}

function Findings(props: {
  title: string;
  findings: Finding[];
  names: ReadonlyMap<string, string>;
}) {
  const { title, findings, names } = props;
  const nav = useNav();
  const rules = [...new Set(findings.map((finding) => finding.rule_id))];
  return (
    <section className={page.section} aria-label={title}>
      <h3>{title}</h3>
      {rules.map((id) => (
        <div key={id}>
          {id !== "" && (
            <button type="button" className={page.more} onClick={() => nav.go({ at: "edit", id })}>
              {names.get(id) ?? id}
            </button>
          )}
          <FindingList findings={findings.filter((finding) => finding.rule_id === id)} />
        </div>
      ))}
    </section>
  );
}
