import { ActionIcon, Menu, UnstyledButton } from "@mantine/core";
import {
  IconDots,
  IconHome,
  IconHomeOff,
  IconMap2,
  IconMapPin,
  IconMapPinShare,
  IconPencil,
  IconTrash,
} from "@tabler/icons-react";
import { useMutation } from "@tanstack/react-query";
import { useState } from "react";
import { deletePlace, editPlace, type PlaceChange } from "../api/placesClient";
import type { Place } from "../api/types";
import { memoInLanguage } from "../texts/memoInLanguage";
import { t } from "../texts/text";
import { Problem } from "../ui/Problem";
import { PlaceForm } from "./PlaceForm";
import classes from "./Places.module.css";
import { poseText } from "./placeText";

interface Props {
  place: Place;
  mayEdit: boolean;
  /** Looks at the way there; null where the robot cannot be sent. */
  onGo: ((place: Place) => void) | null;
  onDeleted: (place: Place) => void;
  /** Given the place as it was, and as it is. */
  onMoved: (before: Place, after: Place) => void;
}

/** One place: a tap shows the way to it, and the menu has the rest. */
export const PlaceRow = memoInLanguage(function PlaceRow({ place, mayEdit, onGo, ...told }: Props) {
  const [editing, setEditing] = useState(false);
  const edit = useMutation({
    mutationFn: (change: PlaceChange) => editPlace(place, change),
    onSuccess: () => setEditing(false),
  });
  const remove = useMutation({
    mutationFn: () => deletePlace(place),
    onSuccess: () => told.onDeleted(place),
  });
  const move = useMutation({
    mutationFn: () => editPlace(place, { to_robot: true }),
    onSuccess: (moved) => told.onMoved(place, moved),
  });
  const { name, note, pose, here, home, map } = place;
  const text = (
    <>
      {home ? (
        <IconHome
          size={18}
          aria-label={t("Home")}
          className={classes.pin}
          data-testid="place-home-mark"
        />
      ) : (
        <IconMapPin size={18} aria-hidden className={classes.pin} />
      )}
      <span className={classes.text}>
        <span className={classes.name}>{name}</span>
        {(note !== "" || !here) && (
          <span className={classes.note}>
            {!here && `${t("Of a map of {label}", { label: map.label })}. `}
            {note}
          </span>
        )}
      </span>
    </>
  );
  const title = t("{pose}; saved by {author}", { pose: poseText(pose), author: place.author });
  if (editing) {
    return (
      <li className={classes.item}>
        <PlaceForm
          title={t("Change {name}", { name })}
          name={name}
          note={note}
          busy={edit.isPending}
          error={edit.error}
          onSave={(newName, newNote) => edit.mutate({ name: newName, note: newNote })}
          onCancel={() => setEditing(false)}
        />
      </li>
    );
  }
  return (
    <li className={classes.item} data-testid={`place-${place.id}`} data-name={name}>
      <div className={classes.row}>
        {onGo !== null && here ? (
          <UnstyledButton
            className={classes.go}
            aria-label={t("Go to {name}", { name })}
            title={title}
            onClick={() => onGo(place)}
            data-testid="place-go"
          >
            {text}
          </UnstyledButton>
        ) : (
          <span className={classes.go} title={title}>
            {text}
          </span>
        )}
        {mayEdit && (
          <Menu position="bottom-end" width={240}>
            <Menu.Target>
              <ActionIcon
                variant="subtle"
                color="gray"
                className={classes.more}
                aria-label={t("More for {name}", { name })}
                loading={edit.isPending || remove.isPending || move.isPending}
                data-testid="place-menu"
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
                data-testid="place-edit"
              >
                {t("Change name or note")}
              </Menu.Item>
              {here && (
                <Menu.Item
                  leftSection={<IconMapPinShare size={16} aria-hidden />}
                  mih={44}
                  onClick={() => move.mutate()}
                  data-testid="place-move"
                >
                  {t("Move to where the robot stands")}
                </Menu.Item>
              )}
              {!here && (
                <Menu.Item
                  leftSection={<IconMap2 size={16} aria-hidden />}
                  mih={44}
                  title={t("Where this map shows the same room: same name, same coordinates")}
                  onClick={() => edit.mutate({ here: true })}
                  data-testid="place-along"
                >
                  {t("Take along to this map")}
                </Menu.Item>
              )}
              <Menu.Item
                leftSection={
                  home ? <IconHomeOff size={16} aria-hidden /> : <IconHome size={16} aria-hidden />
                }
                mih={44}
                title={t("Where the robot belongs: its charger, say")}
                onClick={() => edit.mutate({ home: !home })}
                data-testid="place-home"
              >
                {home ? t("Home no more") : t("Make it home")}
              </Menu.Item>
              <Menu.Item
                leftSection={<IconTrash size={16} aria-hidden />}
                mih={44}
                onClick={() => remove.mutate()}
                data-testid="place-delete"
              >
                {t("Delete")}
              </Menu.Item>
            </Menu.Dropdown>
          </Menu>
        )}
      </div>
      <Problem error={edit.error ?? remove.error ?? move.error} />
    </li>
  );
});
