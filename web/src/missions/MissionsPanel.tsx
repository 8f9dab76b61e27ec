import { ActionIcon, Button, Menu } from "@mantine/core";
import { IconDots, IconPencil, IconPlayerPlay, IconRoute, IconTrash } from "@tabler/icons-react";
import { useMutation } from "@tanstack/react-query";
import { useState } from "react";
import {
  deleteMission,
  editMission,
  restoreMission,
  saveMission,
  startMission,
  startNextMission,
  unqueueMission,
} from "../api/missionsClient";
import type { Mission, MissionList, MissionSave, Missions, Place } from "../api/types";
import placesClasses from "../places/Places.module.css";
import { placesHere } from "../places/placeText";
import { usePlaces } from "../places/usePlaces";
import { useSession } from "../session/SessionContext";
import { useRobot } from "../state/RobotContext";
import { memoInLanguage } from "../texts/memoInLanguage";
import { t } from "../texts/text";
import { Panel } from "../ui/Panel";
import { Problem } from "../ui/Problem";
import { MissionForm } from "./MissionForm";
import classes from "./Missions.module.css";
import { dropDraft } from "./missionDraft";
import { isOver, missionText } from "./missionText";
import { useMissions } from "./useMissions";

/** The missions of the map, and what waits for its turn: start, change, delete. */
export function MissionsPanel() {
  const { list, error } = useMissions();
  const { list: places } = usePlaces();
  const { state, frozen } = useRobot();
  const { session } = useSession();
  const empty = list === null && error === null ? t("Asking the robot for its missions…") : null;
  const now = state?.missions ?? null;
  const busy = now !== null && now.run !== null && !isOver(now.run);
  return (
    <Panel title={t("Missions")} empty={empty} frozen={frozen} testId="missions">
      <div className={placesClasses.panel}>
        <Problem error={error} />
        {now !== null && now.notice !== "" && (
          <p className={classes.warning} role="status">
            {now.notice}
          </p>
        )}
        {now !== null && now.queue.length > 0 && (
          <Queue queue={now.queue} busy={busy} operator={session.role !== "viewer"} />
        )}
        {list !== null && (
          <Contents
            list={list}
            places={places === null ? NO_PLACES : places.places}
            busy={busy}
            operator={session.role !== "viewer"}
          />
        )}
      </div>
    </Panel>
  );
}

const NO_PLACES: Place[] = [];

interface ContentsProps {
  list: MissionList;
  places: Place[];
  /** One runs: what is started waits for its turn. */
  busy: boolean;
  operator: boolean;
}

/** Apart, for it need not be made again with every snapshot of the robot. */
const Contents = memoInLanguage(function Contents({ list, places, busy, operator }: ContentsProps) {
  const [creating, setCreating] = useState(false);
  const [deleted, setDeleted] = useState<Mission | null>(null);
  const finish = () => {
    dropDraft(null);
    setCreating(false);
  };
  const save = useMutation({ mutationFn: saveMission, onSuccess: finish });
  const restore = useMutation({ mutationFn: restoreMission, onSuccess: () => setDeleted(null) });
  const mayEdit = operator && list.available;
  const here = placesHere(places);
  const missions = list.missions.filter((mission) => mission.here);
  const elsewhere = list.missions.length - missions.length;
  return (
    <>
      {list.problem !== "" && <p className={placesClasses.empty}>{list.problem}</p>}
      {missions.length === 0 && list.available && (
        <p className={placesClasses.empty}>
          {t("None on this map yet: a mission drives from place to place.")}
        </p>
      )}
      <ul className={classes.list} aria-label={t("Missions of this map")}>
        {missions.map((mission) => (
          <MissionRow
            key={mission.id}
            mission={mission}
            places={here}
            busy={busy}
            mayEdit={mayEdit}
            onDeleted={setDeleted}
          />
        ))}
      </ul>
      {elsewhere > 0 && (
        <p className={placesClasses.empty}>
          {t("{n, plural, one {# mission} other {# missions}} of other maps.", { n: elsewhere })}
        </p>
      )}
      {deleted !== null && (
        <div className={placesClasses.undo} role="status">
          <span className={placesClasses.text}>{t("Deleted {name}.", { name: deleted.name })}</span>
          <Button
            variant="default"
            size="compact-md"
            loading={restore.isPending}
            onClick={() => restore.mutate(deleted)}
            data-testid="mission-undo"
          >
            {t("Undo")}
          </Button>
          <Problem error={restore.error} />
        </div>
      )}
      {creating ? (
        <MissionForm
          mission={null}
          places={here}
          busy={save.isPending}
          error={save.error}
          onSave={(mission) => save.mutate(mission)}
          onClose={() => setCreating(false)}
          onLeave={finish}
        />
      ) : (
        mayEdit &&
        list.map !== null &&
        (here.length === 0 ? (
          <p className={placesClasses.empty}>{t("Save a place first.")}</p>
        ) : (
          <Button
            variant="default"
            className={placesClasses.add}
            leftSection={<IconRoute size={18} aria-hidden />}
            onClick={() => {
              save.reset();
              setCreating(true);
            }}
            data-testid="mission-add"
          >
            {t("New mission")}
          </Button>
        ))
      )}
    </>
  );
});

interface RowProps {
  mission: Mission;
  places: Place[];
  busy: boolean;
  mayEdit: boolean;
  onDeleted: (mission: Mission) => void;
}

const MissionRow = memoInLanguage(function MissionRow(props: RowProps) {
  const { mission, places, busy, mayEdit, onDeleted } = props;
  const [editing, setEditing] = useState(false);
  const start = useMutation({ mutationFn: () => startMission(mission) });
  const remove = useMutation({
    mutationFn: () => deleteMission(mission),
    onSuccess: () => onDeleted(mission),
  });
  const finish = () => {
    dropDraft(mission);
    setEditing(false);
  };
  const edit = useMutation({
    mutationFn: (changed: MissionSave) => editMission(mission, changed),
    onSuccess: finish,
  });
  if (editing) {
    return (
      <li className={classes.item}>
        <MissionForm
          mission={mission}
          places={places}
          busy={edit.isPending}
          error={edit.error}
          onSave={(changed) => edit.mutate(changed)}
          onClose={() => setEditing(false)}
          onLeave={finish}
        />
      </li>
    );
  }
  return (
    <li className={classes.item} data-testid={`mission-${mission.id}`} data-name={mission.name}>
      <div className={classes.row}>
        <span className={classes.text} title={t("saved by {author}", { author: mission.author })}>
          <span className={classes.name}>{mission.name}</span>
          <span className={classes.note}>{missionText(mission)}</span>
        </span>
        {mayEdit && (
          <>
            <Button
              variant="default"
              size="compact-md"
              leftSection={<IconPlayerPlay size={16} aria-hidden />}
              aria-label={
                busy
                  ? t("Queue {name}", { name: mission.name })
                  : t("Start {name}", { name: mission.name })
              }
              loading={start.isPending}
              onClick={() => start.mutate()}
              data-testid="mission-start"
            >
              {busy ? t("Queue") : t("Start")}
            </Button>
            <Menu position="bottom-end" width={200}>
              <Menu.Target>
                <ActionIcon
                  variant="subtle"
                  color="gray"
                  aria-label={t("More for {name}", { name: mission.name })}
                  loading={remove.isPending}
                  data-testid="mission-menu"
                >
                  <IconDots size={18} aria-hidden />
                </ActionIcon>
              </Menu.Target>
              <Menu.Dropdown>
                <Menu.Item
                  leftSection={<IconPencil size={16} aria-hidden />}
                  mih={44}
                  onClick={() => {
                    edit.reset();
                    setEditing(true);
                  }}
                  data-testid="mission-edit"
                >
                  {t("Change")}
                </Menu.Item>
                <Menu.Item
                  leftSection={<IconTrash size={16} aria-hidden />}
                  mih={44}
                  onClick={() => remove.mutate()}
                  data-testid="mission-delete"
                >
                  {t("Delete")}
                </Menu.Item>
              </Menu.Dropdown>
            </Menu>
          </>
        )}
      </div>
      <Problem error={start.error ?? remove.error} />
    </li>
  );
});

interface QueueProps {
  queue: Missions["queue"];
  busy: boolean;
  operator: boolean;
}

/** What waits for its turn. After one that was cancelled or has failed it waits for a person. */
function Queue({ queue, busy, operator }: QueueProps) {
  const next = useMutation({ mutationFn: startNextMission });
  const remove = useMutation({ mutationFn: unqueueMission });
  return (
    <>
      <ol className={classes.list} aria-label={t("Missions that wait for their turn")}>
        {queue.map((each, index) => (
          <li key={each.number} className={classes.row}>
            <span className={classes.text}>
              <span className={classes.name}>
                {t(index === 0 ? "Next: {name}" : "Then: {name}", {
                  name: each.name === "" ? t("a mission that is gone") : each.name,
                })}
              </span>
              <span className={classes.note}>{t("by {by}", { by: each.by })}</span>
            </span>
            {operator && index === 0 && !busy && (
              <Button
                size="compact-md"
                loading={next.isPending}
                onClick={() => next.mutate()}
                data-testid="mission-next"
              >
                {t("Start")}
              </Button>
            )}
            {operator && (
              <ActionIcon
                variant="subtle"
                color="gray"
                aria-label={t("Take {name} out of the queue", { name: each.name })}
                onClick={() => remove.mutate(each.number)}
              >
                <IconTrash size={16} aria-hidden />
              </ActionIcon>
            )}
          </li>
        ))}
      </ol>
      <Problem error={next.error ?? remove.error} />
    </>
  );
}
