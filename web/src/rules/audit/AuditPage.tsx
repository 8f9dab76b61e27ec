import { Button, TextInput } from "@mantine/core";
import { useDebouncedValue } from "@mantine/hooks";
import { IconDownload } from "@tabler/icons-react";
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { useState } from "react";
import { AUDIT_EXPORT, getAuditLog } from "../../api/auditClient";
import { useAsked } from "../../api/queries";
import type { AuditLog } from "../../api/types";
import { useNow } from "../../state/RobotContext";
import { Problem } from "../../ui/Problem";
import page from "../../ui/page.module.css";
import classes from "./Audit.module.css";
import { AuditRow } from "./AuditRow";

const PAGE = 50;
const AGAIN_MS = 5000;

/** Who did what through the console, newest first: for engineers. */
export function AuditPage() {
  const [typed, setTyped] = useState("");
  const [text] = useDebouncedValue(typed.trim(), 300);
  // Once somebody looks at what is older, the list stays as it is.
  const [still, setStill] = useState(false);
  const now = useNow();
  const client = useQueryClient();
  const key = ["audit", text];
  const { data: log, error } = useAsked({
    key,
    ask: (signal) => getAuditLog(null, text, PAGE, signal),
    again: still ? () => false : AGAIN_MS,
    keep: true,
  });
  const oldest = log?.lines.at(-1)?.seq;
  const older = useMutation({
    mutationFn: (before: number) => getAuditLog(before, text, PAGE),
    onSuccess: (next) =>
      client.setQueryData<AuditLog>(
        key,
        (was) => was && { ...next, lines: [...was.lines, ...next.lines] },
      ),
  });
  return (
    <div className={page.page} data-testid="audit">
      <div className={classes.tools}>
        <TextInput
          size="sm"
          className={classes.filter}
          aria-label="Only lines with"
          placeholder="only lines with …"
          maxLength={200}
          value={typed}
          data-testid="audit-filter"
          onChange={(event) => {
            setTyped(event.currentTarget.value);
            setStill(false);
          }}
        />
        <Button
          component="a"
          variant="default"
          size="sm"
          leftSection={<IconDownload size={16} aria-hidden />}
          href={AUDIT_EXPORT}
          download
          data-testid="audit-export"
        >
          Export
        </Button>
      </div>
      <Problem error={error ?? older.error} />
      {log !== null && log.problem !== "" && (
        <p className={page.problem} role="status">
          {log.problem}
        </p>
      )}
      {log === null && error === null && <p className={page.muted}>Reading the audit log…</p>}
      {log !== null && log.lines.length === 0 && (
        <p className={page.empty}>
          {text === "" ? "Nobody has done anything yet." : "No line has this."}
        </p>
      )}
      {log !== null && log.lines.length > 0 && (
        <table className={classes.table}>
          <thead>
            <tr>
              <th scope="col">Time</th>
              <th scope="col">Who</th>
              <th scope="col">What</th>
              <th scope="col">Outcome</th>
              <th scope="col">From</th>
            </tr>
          </thead>
          <tbody>
            {log.lines.map((line) => (
              <AuditRow key={line.seq} line={line} now={now} />
            ))}
          </tbody>
        </table>
      )}
      {log?.more === true && oldest !== undefined && (
        <Button
          variant="default"
          loading={older.isPending}
          data-testid="audit-older"
          onClick={() => {
            setStill(true);
            older.mutate(oldest);
          }}
        >
          Older
        </Button>
      )}
    </div>
  );
}
