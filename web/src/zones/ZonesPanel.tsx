import { ActionIcon, Button, Menu } from "@mantine/core";
import {
  IconBarrierBlock,
  IconDots,
  IconGauge,
  IconMap2,
  IconPencil,
  IconTrash,
} from "@tabler/icons-react";
import { useMutation } from "@tanstack/react-query";
import { useState } from "react";
import type { Zone, ZoneList } from "../api/types";
import { deleteZone, editZone, restoreZone } from "../api/zonesClient";
import places from "../places/Places.module.css";
import { useSession } from "../session/SessionContext";
import { useRobot } from "../state/RobotContext";
import { wholeDateText } from "../texts/dates";
import { memoInLanguage } from "../texts/memoInLanguage";
import { t } from "../texts/text";
import { langOf, told } from "../texts/told";
import { Panel } from "../ui/Panel";
import { Problem } from "../ui/Problem";
import { masksText } from "./maskText";
import { useZones } from "./useZones";
import classes from "./Zones.module.css";
import { ruleText } from "./zoneText";

interface Props {
  /** Begins to draw a zone, or to change one; null while the scene shows something else. */
  onDraw: ((zone: Zone | null) => void) | null;
}

/** The keep-out and speed zones of the map: draw, change, delete. */
export function ZonesPanel({ onDraw }: Props) {
  const { list, error } = useZones();
  const { frozen } = useRobot();
  const empty = list === null && error === null ? t("Asking the robot for its zones…") : null;
  return (
    <Panel title={t("Zones")} empty={empty} frozen={frozen} testId="zones">
      <div className={places.panel}>
        <Problem error={error} />
        {list !== null && <Contents list={list} onDraw={onDraw} />}
      </div>
    </Panel>
  );
}

/** Apart, for it need not be made again with every snapshot of the robot. */
const Contents = memoInLanguage(function Contents({ list, onDraw }: { list: ZoneList } & Props) {
  const { session } = useSession();
  const mayEdit = session.role !== "viewer" && list.available;
  const [deleted, setDeleted] = useState<Zone | null>(null);
  const undo = useMutation({ mutationFn: restoreZone, onSuccess: () => setDeleted(null) });
  const here = list.zones.filter((zone) => zone.here);
  const elsewhere = list.zones.filter((zone) => !zone.here);
  const [others, setOthers] = useState(false);
  const masks = masksText(list.masks);
  const rows = (zones: Zone[]) =>
    zones.map((zone) => (
      <ZoneRow
        key={zone.id}
        zone={zone}
        mayEdit={mayEdit}
        mayTake={list.map !== null}
        onDraw={onDraw}
        onDeleted={(gone) => {
          undo.reset();
          setDeleted(gone);
        }}
      />
    ));
  return (
    <>
      {list.problem !== "" && (
        <p className={places.empty} lang={langOf(list.problem)}>
          {told(list.problem)}
        </p>
      )}
      {list.map === null ? (
        <p className={places.empty}>{t("The robot has no map, and zones are of a map.")}</p>
      ) : (
        here.length === 0 &&
        list.available && (
          <p className={places.empty}>
            {t("None on this map yet: a zone keeps the robot out, or slow.")}
          </p>
        )
      )}
      <ul className={places.list} aria-label={t("Zones of this map")}>
        {rows(here)}
      </ul>
      {masks !== null && <p className={places.empty}>{masks}</p>}
      {deleted !== null && (
        <div className={places.undo} role="status">
          <span className={places.text}>{t("Deleted {name}.", { name: deleted.name })}</span>
          <Button
            variant="default"
            size="compact-md"
            loading={undo.isPending}
            onClick={() => undo.mutate(deleted)}
            data-testid="zone-undo"
          >
            {t("Undo")}
          </Button>
          <Problem error={undo.error} />
        </div>
      )}
      {elsewhere.length > 0 && (
        <>
          <Button
            variant="subtle"
            size="compact-md"
            aria-expanded={others}
            onClick={() => setOthers(!others)}
            data-testid="zones-elsewhere"
          >
            {t("{n, plural, one {# zone} other {# zones}} of other maps, not in force", {
              n: elsewhere.length,
            })}
          </Button>
          {others && (
            <ul className={places.list} aria-label={t("Zones of other maps")}>
              {rows(elsewhere)}
            </ul>
          )}
        </>
      )}
      {mayEdit && onDraw !== null && list.map !== null && (
        <Button
          variant="default"
          className={places.add}
          leftSection={<IconBarrierBlock size={18} aria-hidden />}
          onClick={() => onDraw(null)}
          data-testid="zone-add"
        >
          {t("Draw a zone")}
        </Button>
      )}
    </>
  );
});

interface RowProps extends Props {
  zone: Zone;
  mayEdit: boolean;
  /** Whether there is a map to take it along to. */
  mayTake: boolean;
  onDeleted: (zone: Zone) => void;
}

function ZoneRow({ zone, mayEdit, mayTake, onDraw, onDeleted }: RowProps) {
  const { session } = useSession();
  const [before, setBefore] = useState<Zone | null>(null);
  const remove = useMutation({
    mutationFn: () => deleteZone(zone),
    onSuccess: () => onDeleted(zone),
  });
  /** Makes it as it was, or the same on the map that the robot has now. */
  const make = useMutation({
    mutationFn: ({ name, kind, speed, corners }: Zone) =>
      editZone(zone, { name, kind, speed, corners: corners.map(([x = 0, y = 0]) => [x, y]) }),
    onSuccess: () => setBefore(null),
  });
  const mine = zone.author === session.user && before?.version === zone.version - 1;
  const Icon = zone.kind === "keep_out" ? IconBarrierBlock : IconGauge;
  return (
    <li className={places.item} data-testid={`zone-${zone.id}`} data-name={zone.name}>
      <div className={places.row}>
        <span
          className={places.go}
          title={t("By {author}, {date}", { author: zone.author, date: wholeDateText(zone.time) })}
        >
          <Icon
            size={18}
            aria-hidden
            className={zone.kind === "keep_out" ? classes.barred : classes.slow}
          />
          <span className={places.text}>
            <span className={places.name}>{zone.name}</span>
            <span className={places.note}>
              {t("{rule}, by {author}", { rule: ruleText(zone), author: zone.author })}
              {!zone.here && `. ${t("Of a map of {label}", { label: zone.map.label })}`}
            </span>
          </span>
        </span>
        {before !== null && mine && (
          <Button
            variant="default"
            size="compact-md"
            loading={make.isPending}
            onClick={() => make.mutate(before)}
            data-testid="zone-revert"
          >
            {t("Undo")}
          </Button>
        )}
        {mayEdit && (
          <Menu position="bottom-end" width={220}>
            <Menu.Target>
              <ActionIcon
                variant="subtle"
                color="gray"
                className={places.more}
                aria-label={t("More for {name}", { name: zone.name })}
                loading={remove.isPending || make.isPending}
                data-testid="zone-menu"
              >
                <IconDots size={18} aria-hidden />
              </ActionIcon>
            </Menu.Target>
            <Menu.Dropdown>
              {zone.here ? (
                <Menu.Item
                  leftSection={<IconPencil size={16} aria-hidden />}
                  mih={44}
                  disabled={onDraw === null}
                  onClick={() => {
                    setBefore(zone);
                    onDraw?.(zone);
                  }}
                  data-testid="zone-edit"
                >
                  {t("Change")}
                </Menu.Item>
              ) : (
                <Menu.Item
                  leftSection={<IconMap2 size={16} aria-hidden />}
                  mih={44}
                  disabled={!mayTake}
                  title={t("Where this map shows the same room: same name, same corners")}
                  onClick={() => make.mutate(zone)}
                  data-testid="zone-along"
                >
                  {t("Take along to this map")}
                </Menu.Item>
              )}
              <Menu.Item
                leftSection={<IconTrash size={16} aria-hidden />}
                mih={44}
                onClick={() => remove.mutate()}
                data-testid="zone-delete"
              >
                {t("Delete")}
              </Menu.Item>
            </Menu.Dropdown>
          </Menu>
        )}
      </div>
      <Problem error={remove.error ?? make.error} />
    </li>
  );
}
