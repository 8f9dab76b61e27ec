import { memoInLanguage } from "../texts/memoInLanguage";
import { t } from "../texts/text";
import classes from "./Scene.module.css";

/** The 3D scene: viser's client of this page's view. Never re-rendered by robot data. */
export const SceneFrame = memoInLanguage(function SceneFrame({ id }: { id: string }) {
  return (
    <iframe
      key={id}
      className={classes.frame}
      data-testid="scene-frame"
      title={t("3D scene: map, robot and paths")}
      src={`/scene/${encodeURIComponent(id)}/`}
    />
  );
});
