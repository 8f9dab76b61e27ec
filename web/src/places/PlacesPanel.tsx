import { Button, TextInput } from "@mantine/core";
import { IconMapPinPlus, IconSearch } from "@tabler/icons-react";
import { useMutation } from "@tanstack/react-query";
import {
  type ComponentType,
  type ReactNode,
  useCallback,
  useEffect,
  useRef,
  useState,
} from "react";
import { editPlace, restorePlace } from "../api/placesClient";
import type { Place, PlaceList } from "../api/types";
import { useSession } from "../session/SessionContext";
import { useRobot } from "../state/RobotContext";
import { memoInLanguage } from "../texts/memoInLanguage";
import { t } from "../texts/text";
import { told } from "../texts/told";
import { broughtIntoView } from "../ui/broughtIntoView";
import { Panel } from "../ui/Panel";
import { Problem } from "../ui/Problem";
import { PlaceRow } from "./PlaceRow";
import classes from "./Places.module.css";
import { placesElsewhere, placesHere, SEARCH_FROM } from "./placeText";
import { SavePlace } from "./SavePlace";
import { usePlaces } from "./usePlaces";

interface Props {
  /** Looks at the way to a place; null while the scene shows something else than the robot. */
  onGo: ((place: Place) => void) | null;
  /** Counts how often somebody asked for the list; the focus then comes here. */
  asked: number;
  /** What else there is to say of a place that was deleted. */
  deleted: ComponentType<{ place: Place }>;
}

/** The named places of the map: go there, save, rename, delete. */
export function PlacesPanel({ onGo, asked, deleted }: Props) {
  const { list, error } = usePlaces();
  const { frozen } = useRobot();
  const { session } = useSession();
  const operator = session.role !== "viewer";
  const root = useRef<HTMLDivElement>(null);
  const ready = list !== null;
  const answered = useRef(0);
  useEffect(() => {
    if (!ready || asked === answered.current) return;
    answered.current = asked;
    broughtIntoView(root.current);
    root.current?.querySelector<HTMLElement>("input, button")?.focus();
  }, [asked, ready]);
  const empty = list === null && error === null ? t("Asking the robot for its places…") : null;
  return (
    <Panel title={t("Places")} empty={empty} frozen={frozen} testId="places">
      <div ref={root} className={classes.panel}>
        <Problem error={error} />
        {list !== null && (
          <Contents
            list={list}
            deleted={deleted}
            onGo={operator ? onGo : null}
            operator={operator}
          />
        )}
      </div>
    </Panel>
  );
}

/** What can be taken back: a place as it was, and as it is; null when it is deleted. */
interface Done {
  before: Place;
  after: Place | null;
}

interface ContentsProps {
  list: PlaceList;
  deleted: Props["deleted"];
  onGo: Props["onGo"];
  operator: boolean;
}

/** Apart, for it need not be made again with every snapshot of the robot. */
const Contents = memoInLanguage(function Contents({
  list,
  deleted: Deleted,
  onGo,
  operator,
}: ContentsProps) {
  const [search, setSearch] = useState("");
  const [naming, setNaming] = useState(false);
  const [done, setDone] = useState<Done | null>(null);
  const [others, setOthers] = useState(false);
  const undo = useMutation({
    mutationFn: ({ before, after }: Done) =>
      after === null ? restorePlace(before) : editPlace(after, { pose: before.pose }),
    onSuccess: () => setDone(null),
  });
  const { reset } = undo;
  const remember = useCallback(
    (before: Place, after: Place | null = null) => {
      reset();
      setDone({ before, after });
    },
    [reset],
  );
  const all = placesHere(list.places);
  const found = placesHere(list.places, search);
  const elsewhere = placesElsewhere(list.places);
  const searches = all.length > SEARCH_FROM;
  const mayEdit = operator && list.available;
  const rows = (places: Place[]) =>
    places.map((place) => (
      <PlaceRow
        key={place.id}
        place={place}
        mayEdit={mayEdit}
        onGo={onGo}
        onDeleted={remember}
        onMoved={remember}
      />
    ));
  return (
    <>
      {list.problem !== "" && <Note>{told(list.problem)}</Note>}
      {searches && (
        <TextInput
          type="search"
          aria-label={t("Search places")}
          placeholder={t("Search {n} places", { n: all.length })}
          leftSection={<IconSearch size={16} aria-hidden />}
          value={search}
          onChange={(event) => setSearch(event.currentTarget.value)}
          onKeyDown={(event) => {
            if (event.key === "Escape") setSearch("");
          }}
          data-testid="place-search"
        />
      )}
      {list.map === null && <Note>{t("The robot has no map, and places are of a map.")}</Note>}
      {list.map !== null && all.length === 0 && list.available && (
        <Note>{t("None on this map yet: a place has a name, and is two presses away.")}</Note>
      )}
      {searches && found.length === 0 && <Note>{t("No place has that in its name or note.")}</Note>}
      <ul className={classes.list} aria-label={t("Places of this map")}>
        {rows(searches ? found : all)}
      </ul>
      {done !== null && (
        <div className={classes.undo} role="status">
          <span className={classes.text}>
            {done.after === null
              ? t("Deleted {name}.", { name: done.before.name })
              : t("Moved {name}.", { name: done.before.name })}
            {done.after === null && <Deleted place={done.before} />}
          </span>
          <Button
            variant="default"
            size="compact-md"
            loading={undo.isPending}
            onClick={() => undo.mutate(done)}
            data-testid="place-undo"
          >
            {t("Undo")}
          </Button>
          <Problem error={undo.error} />
        </div>
      )}
      {naming ? (
        <SavePlace pose={null} onDone={() => setNaming(false)} />
      ) : (
        mayEdit &&
        list.map !== null && (
          <Button
            variant="default"
            className={classes.add}
            leftSection={<IconMapPinPlus size={18} aria-hidden />}
            onClick={() => setNaming(true)}
            data-testid="place-add"
          >
            {t("Save where the robot stands")}
          </Button>
        )
      )}
      {elsewhere.length > 0 && (
        <>
          <Button
            variant="subtle"
            size="compact-md"
            aria-expanded={others}
            onClick={() => setOthers(!others)}
            data-testid="places-elsewhere"
          >
            {t("{n, plural, one {# place} other {# places}} of other maps", {
              n: elsewhere.length,
            })}
          </Button>
          {others && (
            <ul className={classes.list} aria-label={t("Places of other maps")}>
              {rows(elsewhere)}
            </ul>
          )}
        </>
      )}
    </>
  );
});

const Note = ({ children }: { children: ReactNode }) => <p className={classes.empty}>{children}</p>;
