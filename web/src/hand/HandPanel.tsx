import { Button, CloseButton, Slider, UnstyledButton } from "@mantine/core";
import { IconChevronsLeft, IconChevronsRight, IconSteeringWheel } from "@tabler/icons-react";
import { fixed } from "../format";
import { isUnderWay } from "../goal/goalText";
import { useSession } from "../session/SessionContext";
import { useRobot } from "../state/RobotContext";
import { useStop } from "../stop/StopContext";
import { memoInLanguage } from "../texts/memoInLanguage";
import { t } from "../texts/text";
import { shown, speedUnit } from "../texts/units";
import classes from "./Hand.module.css";
import { type Hand, LEAST_SHARE, useHand } from "./HandContext";
import { drivenText, heldBackText } from "./handText";
import { Stick } from "./Stick";

/** A strip below the scene, which it never covers: the wheel, or who has it. */
export const HandPanel = memoInLanguage(function HandPanel() {
  const hand = useHand();
  if (!hand.open) return null;
  return (
    <section
      className={classes.strip}
      data-testid="hand-panel"
      data-yours={hand.yours || undefined}
      aria-label={t("Drive by hand")}
    >
      {hand.yours ? <Wheel hand={hand} /> : <Taking hand={hand} />}
    </section>
  );
});

/** Whoever has the wheel. */
function Wheel({ hand }: { hand: Hand }) {
  const { drive } = useStop();
  const { limits, loop, share, askedBy } = hand;
  const held = heldBackText(drive);
  return (
    <>
      <div className={classes.controls}>
        <div className={classes.head}>
          <strong>{t("You drive")}</strong>
          <Button
            size="compact-md"
            variant="default"
            className={classes.give}
            onClick={hand.give}
            data-testid="hand-give"
          >
            {t("Give up")}
          </Button>
        </div>
        <p className={classes.notice} role="status" data-testid="hand-notice">
          {askedBy !== "" && (
            <span className={classes.asked}>
              {t("{askedBy} asks for the wheel.", { askedBy })}{" "}
            </span>
          )}
          {held !== null && <span className={classes.held}>▲ {held}</span>}
          {held === null && askedBy === "" && (
            <>
              <span className={classes.mouse}>
                {t("Hold the stick, W A S D or the arrows. Esc gives up.")}
              </span>
              <span className={classes.touch}>{t("Hold the stick; let go to stand.")}</span>
            </>
          )}
        </p>
        <div className={classes.speed}>
          <span className={classes.speedText} data-testid="hand-speed">
            {t("at most {speed}", {
              speed: `${fixed(shown(share * limits.vx), 2)} ${speedUnit()}`,
            })}
          </span>
          <Slider
            className={classes.slider}
            min={LEAST_SHARE}
            max={1}
            step={0.05}
            label={null}
            value={share}
            onChange={hand.setShare}
            thumbLabel={t("Speed limit")}
          />
        </div>
      </div>
      {limits.vy > 0 && <Aside hand={hand} />}
      <Stick loop={loop} />
    </>
  );
}

/** Sideways, where the robot can. */
function Aside({ hand }: { hand: Hand }) {
  const slide = (aside: number, label: string, Icon: typeof IconChevronsLeft) => (
    <UnstyledButton
      className={classes.aside}
      aria-label={label}
      title={label}
      onPointerDown={(event) => {
        if (event.button !== 0) return;
        event.currentTarget.setPointerCapture(event.pointerId);
        hand.loop.moveAside(aside);
      }}
      onPointerUp={() => hand.loop.moveAside(0)}
      onPointerCancel={() => hand.loop.moveAside(0)}
      onLostPointerCapture={() => hand.loop.moveAside(0)}
      onContextMenu={(event) => event.preventDefault()}
    >
      <Icon size={24} aria-hidden />
    </UnstyledButton>
  );
  return (
    <div className={classes.asides}>
      {slide(1, t("Hold to go to the left (Q)"), IconChevronsLeft)}
      {slide(-1, t("Hold to go to the right (E)"), IconChevronsRight)}
    </div>
  );
}

/** Whoever has not got it. */
function Taking({ hand }: { hand: Hand }) {
  const { state } = useRobot();
  const { drive } = useStop();
  const { session } = useSession();
  const drivenBy = drive?.driven_by ?? "";
  const busy = hand.asking || !hand.connected;
  return (
    <>
      <div className={classes.controls}>
        <strong>{drivenBy === "" ? t("Drive by hand") : drivenText(drivenBy, false)}</strong>
        <p className={classes.notice} role="status" data-testid="hand-notice">
          {hand.message !== "" ? (
            <span className={classes.held}>▲ {hand.message}</span>
          ) : !hand.connected ? (
            t("Connecting…")
          ) : drive === null ? (
            t("The drive manager is silent: nobody can drive.")
          ) : drivenBy !== "" ? (
            session.role === "engineer" ? (
              t("Ask for the wheel, or take it over: the robot stands then.")
            ) : (
              t("Ask for the wheel; an engineer may take it over.")
            )
          ) : isUnderWay(state?.goal ?? null) ? (
            t("Taking the wheel ends the goal that the robot drives to.")
          ) : (
            t("The robot moves only while you hold the stick or a key.")
          )}
        </p>
      </div>
      <div className={classes.buttons}>
        {drivenBy === "" ? (
          <Button
            size="md"
            leftSection={<IconSteeringWheel size={20} aria-hidden />}
            disabled={busy || drive === null}
            onClick={() => hand.take(false)}
            data-testid="hand-take"
          >
            {t("Take the wheel")}
          </Button>
        ) : (
          <>
            <Button
              size="md"
              variant="default"
              disabled={busy}
              onClick={hand.ask}
              data-testid="hand-ask"
            >
              {t("Ask")}
            </Button>
            {session.role === "engineer" && (
              <Button
                size="md"
                variant="default"
                disabled={busy}
                onClick={() => hand.take(true)}
                data-testid="hand-take-over"
              >
                {t("Take over")}
              </Button>
            )}
          </>
        )}
        <CloseButton size="lg" aria-label={t("Close driving by hand")} onClick={hand.close} />
      </div>
    </>
  );
}
