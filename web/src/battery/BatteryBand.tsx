import { Button } from "@mantine/core";
import { IconHome } from "@tabler/icons-react";
import type { Place } from "../api/types";
import { usePlaces } from "../places/usePlaces";
import { useRobot } from "../state/RobotContext";
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
      title={`Battery low: ${chargeText(battery)}`}
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
            Go home
          </Button>
        )
      }
    >
      {home === undefined
        ? "Charge it. A place can be made its home, in the place's menu: then this leads there."
        : `Its home on this map is ${home.name}.`}
    </Band>
  );
}
