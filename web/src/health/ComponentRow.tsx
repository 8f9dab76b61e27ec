import type { ReactNode } from "react";
import type { Component } from "../api/types";
import { ageText, hertzText } from "../format";
import { componentLevel, componentWord, FROZEN_S } from "../state/overall";
import classes from "./Health.module.css";
import { HealthRow } from "./HealthRow";
import { ProcessFacts } from "./ProcessFacts";

export function ComponentRow({ component, elapsed }: { component: Component; elapsed: number }) {
  const age = component.age + elapsed;
  const level = componentLevel(component, elapsed);
  const complaints = [
    ["Topics", component.src_topics],
    ["Components", component.src_components],
    ["Algorithms", component.src_algorithms],
  ] as const;
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
        {complaints.map(
          ([what, names]) =>
            names.length > 0 && (
              <Fact key={what} name={what}>
                {names.map((source) => (
                  <code key={source}>{source}</code>
                ))}
              </Fact>
            ),
        )}
        {component.process !== null && <ProcessFacts process={component.process} />}
        {component.inputs.length > 0 && (
          <Fact name="Inputs">
            {component.inputs.map((input) => (
              <span key={input.topic} data-late={input.stale || undefined}>
                <code>{input.topic}</code>{" "}
                {input.age === null ? "never" : ageText(input.age + elapsed)}
                {input.rate !== null && `, ${hertzText(input.rate)}`}
                {input.stale && " ▲ late"}
              </span>
            ))}
          </Fact>
        )}
        <Fact name="Topic">
          <code>{component.topic}</code>
        </Fact>
      </dl>
    </HealthRow>
  );
}

function Fact({ name, children }: { name: string; children: ReactNode }) {
  return (
    <>
      <dt>{name}</dt>
      <dd>{children}</dd>
    </>
  );
}
