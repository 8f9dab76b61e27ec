import type { Component } from "../api/types";

/** The process behind a component: how it is, and how often it had to be started again. */
export function ProcessFacts({ process }: { process: NonNullable<Component["process"]> }) {
  const { state, pid, restarts, reason } = process;
  return (
    <>
      <dt>Process</dt>
      <dd>
        {state}
        {pid > 0 && `, pid ${pid}`}
      </dd>
      <dt>Restarts</dt>
      <dd>
        {restarts}
        {reason !== "" && `, last: ${reason}`}
      </dd>
    </>
  );
}
