import type { Component } from "../api/types";
import { bytesText, percentText } from "../format";
import { t } from "../texts/text";
import { told } from "../texts/told";

/** The process behind a component: how it is, and how often it had to be started again. */
export function ProcessFacts({ process }: { process: NonNullable<Component["process"]> }) {
  const { state, pid, restarts, reason, cpu, memory } = process;
  return (
    <>
      <dt>{t("Process")}</dt>
      <dd>
        {t(state)}
        {pid > 0 && `, pid ${pid}`}
      </dd>
      {memory !== null && (
        <>
          <dt>{t("Takes")}</dt>
          <dd data-testid="process-usage">
            {cpu !== null && `${t("{percent} of a core", { percent: percentText(cpu) })}, `}
            {t("{bytes} of memory", { bytes: bytesText(memory) })}
          </dd>
        </>
      )}
      <dt>{t("Restarts")}</dt>
      <dd>
        {restarts}
        {reason !== "" && `, ${t("last: {reason}", { reason: told(reason) })}`}
      </dd>
    </>
  );
}
