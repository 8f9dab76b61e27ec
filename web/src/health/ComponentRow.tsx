import type { ReactNode } from "react";
import type { Component } from "../api/types";
import { ageText, hertzText } from "../format";
import { componentLevel, componentWord, FROZEN_S } from "../state/overall";
import { t } from "../texts/text";
import { langOf, told } from "../texts/told";
import classes from "./Health.module.css";
import { HealthRow } from "./HealthRow";
import { ProcessFacts } from "./ProcessFacts";

export function ComponentRow({ component, elapsed }: { component: Component; elapsed: number }) {
  const age = component.age + elapsed;
  const level = componentLevel(component, elapsed);
  const complaints = [
    [t("Topics"), component.src_topics],
    [t("Components"), component.src_components],
    [t("Algorithms"), component.src_algorithms],
  ] as const;
  return (
    <HealthRow
      level={level}
      label={told(component.label)}
      word={componentWord(component, elapsed)}
      age={ageText(age)}
      stale={age > FROZEN_S}
      testId={`health-${component.name}`}
    >
      <p lang={langOf(component.message)}>
        {component.message === "" ? t("No message.") : told(component.message)}
      </p>
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
          <Fact name={t("Inputs")}>
            {component.inputs.map((input) => (
              <span key={input.topic} data-late={input.stale || undefined}>
                <code>{input.topic}</code>{" "}
                {input.age === null ? t("never") : ageText(input.age + elapsed)}
                {input.rate !== null && `, ${hertzText(input.rate)}`}
                {input.stale && ` ▲ ${t("late")}`}
              </span>
            ))}
          </Fact>
        )}
        <Fact name={t("Topic")}>
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
