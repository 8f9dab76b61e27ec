import { ActionIcon, Button, Menu } from "@mantine/core";
import { IconBarrierBlock, IconDots, IconGauge, IconPencil, IconTrash } from "@tabler/icons-react";
import { useMutation } from "@tanstack/react-query";
import { useState } from "react";
import type { Zone, ZoneList } from "../api/types";
import { deleteZone, editZone, restoreZone } from "../api/zonesClient";
import places from "../places/Places.module.css";
import { useSession } from "../session/SessionContext";
import { useRobot } from "../state/RobotContext";
import { Panel } from "../ui/Panel";
import { Problem } from "../ui/Problem";
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
  const empty = list === null && error === null ? "Asking the robot for its zones…" : null;
  return (
    <Panel title="Zones" empty={empty} frozen={frozen} testId="zones">
      <div className={places.panel}>
        <Problem error={error} />
        {list !== null && <Contents list={list} onDraw={onDraw} />}
      </div>
    </Panel>
  );
}

function Contents({ list, onDraw }: { list: ZoneList } & Props) {
  const { session } = useSession();
  const mayEdit = session.role !== "viewer" && list.available;
  const [deleted, setDeleted] = useState<Zone | null>(null);
  const undo = useMutation({ mutationFn: restoreZone, onSuccess: () => setDeleted(null) });
  const here = list.zones.filter((zone) => zone.here);
  const others = list.zones.length - here.length;
  return (
    <>
      {list.problem !== "" && <p className={places.empty}>{list.problem}</p>}
      {list.map === null ? (
        <p className={places.empty}>The robot has no map, and zones are of a map.</p>
      ) : (
        here.length === 0 && list.available && <p className={places.empty}>None on this map yet.</p>
      )}
      <ul className={places.list} aria-label="Zones of this map">
        {here.map((zone) => (
          <ZoneRow
            key={zone.id}
            zone={zone}
            mayEdit={mayEdit}
            onDraw={onDraw}
            onDeleted={(gone) => {
              undo.reset();
              setDeleted(gone);
            }}
          />
        ))}
      </ul>
      {deleted !== null && (
        <div className={places.undo} role="status">
          <span className={places.text}>Deleted {deleted.name}.</span>
          <Button
            variant="default"
            size="compact-md"
            loading={undo.isPending}
            onClick={() => undo.mutate(deleted)}
            data-testid="zone-undo"
          >
            Undo
          </Button>
          <Problem error={undo.error} />
        </div>
      )}
      {others > 0 && (
        <p className={places.empty}>
          {others === 1 ? "1 zone" : `${others} zones`} of other maps, not in force.
        </p>
      )}
      {mayEdit && onDraw !== null && list.map !== null && (
        <Button
          variant="default"
          className={places.add}
          leftSection={<IconBarrierBlock size={18} aria-hidden />}
          onClick={() => onDraw(null)}
          data-testid="zone-add"
        >
          Draw a zone
        </Button>
      )}
    </>
  );
}

interface RowProps extends Props {
  zone: Zone;
  mayEdit: boolean;
  onDeleted: (zone: Zone) => void;
}

function ZoneRow({ zone, mayEdit, onDraw, onDeleted }: RowProps) {
  const [before, setBefore] = useState<Zone | null>(null);
  const remove = useMutation({
    mutationFn: () => deleteZone(zone),
    onSuccess: () => onDeleted(zone),
  });
  const revert = useMutation({
    mutationFn: ({ name, kind, speed, corners }: Zone) =>
      editZone(zone, { name, kind, speed, corners: corners.map(([x = 0, y = 0]) => [x, y]) }),
    onSuccess: () => setBefore(null),
  });
  const Icon = zone.kind === "keep_out" ? IconBarrierBlock : IconGauge;
  return (
    <li className={places.item} data-testid={`zone-${zone.id}`} data-name={zone.name}>
      <div className={places.row}>
        <span
          className={places.go}
          title={`By ${zone.author}, ${new Date(1000 * zone.time).toLocaleString()}`}
        >
          <Icon
            size={18}
            aria-hidden
            className={zone.kind === "keep_out" ? classes.barred : classes.slow}
          />
          <span className={places.text}>
            <span className={places.name}>{zone.name}</span>
            <span className={places.note}>
              {ruleText(zone)}, by {zone.author}
            </span>
          </span>
        </span>
        {before !== null && before.version < zone.version && (
          <Button
            variant="default"
            size="compact-md"
            loading={revert.isPending}
            onClick={() => revert.mutate(before)}
            data-testid="zone-revert"
          >
            Undo
          </Button>
        )}
        {mayEdit && (
          <Menu position="bottom-end" width={220}>
            <Menu.Target>
              <ActionIcon
                variant="subtle"
                color="gray"
                className={places.more}
                aria-label={`More for ${zone.name}`}
                loading={remove.isPending}
                data-testid="zone-menu"
              >
                <IconDots size={18} aria-hidden />
              </ActionIcon>
            </Menu.Target>
            <Menu.Dropdown>
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
                Change
              </Menu.Item>
              <Menu.Item
                leftSection={<IconTrash size={16} aria-hidden />}
                mih={44}
                onClick={() => remove.mutate()}
                data-testid="zone-delete"
              >
                Delete
              </Menu.Item>
            </Menu.Dropdown>
          </Menu>
        )}
      </div>
      <Problem error={remove.error ?? revert.error} />
    </li>
  );
}
