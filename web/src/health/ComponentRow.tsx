import type { Component } from "../api/types";
import { ageText } from "../format";
import { componentLevel, componentWord, FROZEN_S } from "../state/overall";
import classes from "./Health.module.css";
import { HealthRow } from "./HealthRow";

export function ComponentRow({ component, elapsed }: { component: Component; elapsed: number }) {
  const age = component.age + elapsed;
  const level = componentLevel(component, elapsed);
  return (
    <HealthRow
      level={level}
      label={component.label}
      word={componentWord(component, elapsed)}
      age={ageText(age)}
      stale={age > FROZEN_S}
      testId={`health-${component.name}`}
    >
      <p>{component.message === "" ? "No message." : component.message}</p>
      <dl className={classes.facts}>
        {component.sources.length > 0 && (
          <>
            <dt>Source</dt>
            <dd>
              {component.sources.map((source) => (
                <code key={source}>{source}</code>
              ))}
            </dd>
          </>
        )}
        <dt>Topic</dt>
        <dd>
          <code>{component.topic}</code>
        </dd>
      </dl>
    </HealthRow>
  );
}
