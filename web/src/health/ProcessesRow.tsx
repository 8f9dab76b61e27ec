import type { State } from "../api/types";
import { bytesText, percentText } from "../format";
import { t } from "../texts/text";
import type { Level } from "../ui/StatusMark";
import classes from "./Health.module.css";
import { HealthRow } from "./HealthRow";

type Process = State["processes"][number];

const LOST: ReadonlySet<Process["state"]> = new Set(["dead", "stuck", "given up"]);

/** What the robot's program takes of its machine: all of it, and each of its processes. */
export function ProcessesRow({ processes }: { processes: readonly Process[] }) {
  const known = processes.filter(({ memory }) => memory !== null);
  if (known.length === 0) return null;
  const all = known.reduce((sum, { cpu }) => sum + (cpu ?? 0), 0);
  const lost = processes.some(({ state }) => LOST.has(state));
  const level: Level = lost ? "failed" : "healthy";
  return (
    <HealthRow
      level={level}
      label={t("Processes")}
      word={t("{percent} of a core", { percent: percentText(all) })}
      age=""
      stale={false}
      testId="processes"
    >
      <table className={classes.processes}>
        <thead>
          <tr>
            <th scope="col">{t("Process")}</th>
            <th scope="col">{t("Core")}</th>
            <th scope="col">{t("Memory")}</th>
            <th scope="col">{t("Restarts")}</th>
          </tr>
        </thead>
        <tbody>
          {processes.map(({ name, state, cpu, memory, restarts }) => (
            <tr key={name} data-lost={LOST.has(state) || undefined}>
              <th scope="row">
                {name}
                {state !== "active" && ` (${t(state)})`}
              </th>
              <td>{cpu === null ? "–" : percentText(cpu)}</td>
              <td>{memory === null ? "–" : bytesText(memory)}</td>
              <td>{restarts}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </HealthRow>
  );
}
