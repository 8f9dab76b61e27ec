import type { Component } from "../api/types";
import { bytesText, percentText } from "../format";

/** The process behind a component: how it is, and how often it had to be started again. */
export function ProcessFacts({ process }: { process: NonNullable<Component["process"]> }) {
  const { state, pid, restarts, reason, cpu, memory } = process;
  return (
    <>
      <dt>Process</dt>
      <dd>
        {state}
        {pid > 0 && `, pid ${pid}`}
      </dd>
      {memory !== null && (
        <>
          <dt>Takes</dt>
          <dd data-testid="process-usage">
            {cpu !== null && `${percentText(cpu)} of a core, `}
            {bytesText(memory)} of memory
          </dd>
        </>
      )}
      <dt>Restarts</dt>
      <dd>
        {restarts}
        {reason !== "" && `, last: ${reason}`}
      </dd>
    </>
  );
}
