import { useMutation } from "@tanstack/react-query";
import { useState } from "react";
import { checkGoal } from "../api/client";
import { savePlace } from "../api/placesClient";
import { useAsked } from "../api/queries";
import type { GoalCheck, Place } from "../api/types";
import { useRobot } from "../state/RobotContext";
import { t } from "../texts/text";
import { told } from "../texts/told";
import { PlaceForm } from "./PlaceForm";

interface Props {
  /** Without one the place is where the robot stands when it is saved. */
  pose: Place["pose"] | null;
  onDone: () => void;
}

/** A new place of the map that the robot has now. */
export function SavePlace({ pose, onDone }: Props) {
  const save = useMutation({
    mutationFn: (given: { name: string; note: string }) => savePlace({ ...given, pose }),
    onSuccess: onDone,
  });
  const { state } = useRobot();
  // Where it stood when the form was opened: a robot that drives is no reason to ask again.
  const [asked] = useState(pose ?? state?.pose ?? null);
  const { data: check } = useAsked({
    key: ["place-check", asked?.x, asked?.y],
    enabled: asked !== null,
    ask: (signal) => checkGoal({ x: asked?.x ?? 0, y: asked?.y ?? 0 }, signal),
  });
  return (
    <PlaceForm
      title={pose ? t("Save this place") : t("Save where the robot stands")}
      warning={check === null ? "" : outOfReach(check)}
      busy={save.isPending}
      error={save.error}
      onSave={(name, note) => save.mutate({ name, note })}
      onCancel={onDone}
    />
  );
}

/** What somebody who saves a place should know, that the robot could not be sent to; else empty. */
export function outOfReach({ ok, message, nearest }: GoalCheck): string {
  if (ok) return "";
  const why = `${t("The robot could not be sent here now:")} ${told(message)}`;
  if (nearest === null) return why;
  const point = { x: nearest.x.toFixed(2), y: nearest.y.toFixed(2) };
  return `${why} ${t("The nearest point that it can get to is ({x}, {y}).", point)}`;
}
