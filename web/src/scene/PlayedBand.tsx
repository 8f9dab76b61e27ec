import { Button } from "@mantine/core";
import { t } from "../texts/text";
import { Band } from "../ui/Band";
import classes from "./Scene.module.css";
import { useStage } from "./StageContext";
import { SIDES } from "./sides";

/** Says that what is seen is no robot, which of the two is which, and leads back. */
export function PlayedBand() {
  const { shown, leave } = useStage();
  if (shown === null) return null;
  return (
    <Band
      tone="notice"
      testId="played-band"
      title={t("Playing a drill: the robot itself is not shown.")}
      action={
        <Button variant="default" onClick={leave} data-testid="played-leave">
          {t("Back to the robot")}
        </Button>
      }
    >
      {t("Nothing here drives it, and STOP stops it as always.")}
      <span className={classes.legend}>
        {SIDES.map(({ side, name }) => (
          <span key={side}>
            <i data-side={side} aria-hidden />
            {t(name)}
          </span>
        ))}
      </span>
    </Band>
  );
}
