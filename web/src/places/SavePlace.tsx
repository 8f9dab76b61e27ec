import { useMutation } from "@tanstack/react-query";
import { savePlace } from "../api/placesClient";
import type { Place } from "../api/types";
import { t } from "../texts/text";
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
  return (
    <PlaceForm
      title={pose ? t("Save this place") : t("Save where the robot stands")}
      busy={save.isPending}
      error={save.error}
      onSave={(name, note) => save.mutate({ name, note })}
      onCancel={onDone}
    />
  );
}
