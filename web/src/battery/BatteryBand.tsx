import { Button } from "@mantine/core";
import { IconHome } from "@tabler/icons-react";
import type { Place } from "../api/types";
import { usePlaces } from "../places/usePlaces";
import { useRobot } from "../state/RobotContext";
import { t } from "../texts/text";
import { Band } from "../ui/Band";
import { chargeText } from "./batteryText";

interface Props {
  /** Looks at the way to a place; null where the robot cannot be sent. */
  onGo: ((place: Place) => void) | null;
}

/** The battery is low, and nobody charges it. */
export function BatteryBand({ onGo }: Props) {
  const { state } = useRobot();
  const { list } = usePlaces();
  const battery = state?.battery ?? null;
  if (battery === null || !battery.low || battery.charging) return null;
  const home = list?.places.find((place) => place.home && place.here);
  return (
    <Band
      tone="notice"
      title={t("Battery low: {charge}", { charge: chargeText(battery) })}
      testId="battery-band"
      action={
        home !== undefined &&
        onGo !== null && (
          <Button
            variant="default"
            leftSection={<IconHome size={16} aria-hidden />}
            data-testid="go-home"
            onClick={() => onGo(home)}
          >
            {t("Go home")}
          </Button>
        )
      }
    >
      {home === undefined
        ? t("Charge it. A place can be made its home, in the place's menu: then this leads there.")
        : t("Its home on this map is {name}.", { name: home.name })}
    </Band>
  );
}
