import type { Localisation } from "../api/types";
import { ageText } from "../format";
import { mapFit } from "../state/localisation";
import { t } from "../texts/text";
import { HealthRow } from "./HealthRow";

/** How well the scan fits the map: whether the robot knows where it is. */
export function FitRow({ localisation, elapsed }: { localisation: Localisation; elapsed: number }) {
  const { level, figure, sentence } = mapFit(localisation, elapsed);
  const { age } = localisation;
  return (
    <HealthRow
      level={level}
      label={t("Scan fits map")}
      word={figure === "–" ? t("Unknown") : figure}
      age={age === null ? "–" : ageText(age + elapsed)}
      stale={level === "unknown"}
      testId="fit-row"
    >
      <p>{sentence}</p>
    </HealthRow>
  );
}
