import { memo } from "react";
import classes from "./Scene.module.css";
import { drawsWebGl } from "./webgl";

/** The 3D scene: viser's client of this page's view. Never re-rendered by robot data. */
export const SceneFrame = memo(function SceneFrame({ id }: { id: string }) {
  if (!drawsWebGl()) {
    return (
      <p className={classes.waiting} data-testid="no-webgl">
        This browser does not draw in three dimensions here (no WebGL), so the scene stays empty.
        Health, rules, goals by their coordinates and STOP work as always. Turn on hardware
        acceleration in the browser's settings, or take another browser or device.
      </p>
    );
  }
  return (
    <iframe
      key={id}
      className={classes.frame}
      data-testid="scene-frame"
      title="3D scene: map, robot and paths"
      src={`/scene/${encodeURIComponent(id)}/`}
    />
  );
});
