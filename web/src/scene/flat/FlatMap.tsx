import { ActionIcon } from "@mantine/core";
import { useElementSize, useMediaQuery, useMergedRef } from "@mantine/hooks";
import { IconArrowsMaximize, IconMinus, IconPlus } from "@tabler/icons-react";
import { type ReactNode, useEffect, useRef } from "react";
import { useRobot } from "../../state/RobotContext";
import { t } from "../../texts/text";
import type { ViewHandle } from "../useView";
import { drawsWebGl } from "../webgl";
import { type Point, toFloor } from "./camera";
import { coloursOf } from "./colours";
import classes from "./FlatMap.module.css";
import { type Considered, type DrawnZone, type Named, type Picture, paint } from "./paint";
import { useCamera } from "./useCamera";
import { useCells } from "./useCells";
import { useFlatWorld } from "./useFlatWorld";

/** Around the robot, as long as there is no map, m. */
const SURROUNDINGS = 5;
const ZOOM = 1.5;

/** Pixels that the strip of tools takes of the map, and the map's own buttons; with a gap each. */
const UNDER_TOOLS = { top: 58 + 2 * 8, right: 0 };
const UNDER_BUTTONS = { top: 0, right: 44 + 12 };

interface Props {
  handle: ViewHandle;
  considered: Considered | null;
  places: readonly Named[];
  zones: readonly DrawnZone[];
  /** Corners of a zone that is being drawn, m. */
  sketch: readonly Point[];
  /** Points that are measured between, m. */
  measured: readonly Point[];
  /** What lies over the map; `floorAt` says which place (m) is at fractions of the picture. */
  children: (floorAt: (at: readonly [number, number]) => Point) => ReactNode;
}

/** The map from above, drawn by the page itself: for browsers without WebGL, and for weak ones. */
export function FlatMap(props: Props) {
  const { handle, considered, places, zones, sketch, measured, children } = props;
  const { view, change } = handle;
  const { world, live } = useFlatWorld(view?.id ?? null);
  const { state, frozen } = useRobot();
  const theme = view?.theme ?? "light";
  const { cells, missing } = useCells(world.map?.version ?? null, theme);
  const { ref: sized, width, height } = useElementSize();
  const robot = state?.pose ?? null;
  const [x, y] = robot === null ? [0, 0] : [robot.x, robot.y];
  const size = { width, height };
  // The tools lie over the map where there is no room beside it; elsewhere the buttons do.
  const narrow = useMediaQuery("(max-width: 1100px)", false, { getInitialValueInEffect: false });
  const { camera, root, zoom, showWhole, handlers } = useCamera({
    size,
    bounds: world.map?.bounds ?? [
      x - SURROUNDINGS,
      y - SURROUNDINGS,
      x + SURROUNDINGS,
      y + SURROUNDINGS,
    ],
    covered: narrow ? UNDER_TOOLS : UNDER_BUTTONS,
    followed: view?.follow && robot !== null ? [x, y] : null,
    onMoved: () => {
      if (view?.follow) change({ follow: false });
    },
  });
  const canvas = usePainted(
    view === null
      ? null
      : {
          size,
          camera,
          colours: coloursOf(theme),
          layers: view.layers,
          world,
          cells,
          robot,
          considered,
          places,
          zones,
          sketch,
          measured,
          old: frozen || !live,
        },
  );
  return (
    <div ref={useMergedRef(root, sized)} className={classes.map} data-testid="flat-map">
      <canvas
        ref={canvas}
        className={classes.canvas}
        role="img"
        aria-label={t("Map from above: robot, path and laser scan")}
        data-testid="flat-canvas"
        data-cells={cells === null ? undefined : (world.map?.version ?? undefined)}
        {...handlers}
      />
      <div className={classes.buttons}>
        <MapButton label={t("Larger")} onClick={() => zoom(ZOOM)} Icon={IconPlus} />
        <MapButton label={t("Smaller")} onClick={() => zoom(1 / ZOOM)} Icon={IconMinus} />
        <MapButton label={t("Whole map")} onClick={showWhole} Icon={IconArrowsMaximize} />
      </div>
      {(!drawsWebGl() || missing) && (
        <p className={classes.note} role="status">
          {!drawsWebGl() && (
            <span data-testid="no-webgl">
              {t(
                "This browser does not draw in three dimensions here (no WebGL): the map is flat.",
              )}{" "}
            </span>
          )}
          {missing && t("The map's picture does not come; it is asked for again.")}
        </p>
      )}
      {children(([u, v]) => toFloor(camera, size, [u * width, v * height]))}
    </div>
  );
}

/** A canvas that shows the newest picture, drawn once for each of the screen's at most. */
function usePainted(picture: Picture | null) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const newest = useRef(picture);
  const frame = useRef<number | null>(null);
  useEffect(() => {
    newest.current = picture;
    frame.current ??= requestAnimationFrame(() => {
      frame.current = null;
      if (canvas.current !== null && newest.current !== null) draw(canvas.current, newest.current);
    });
  });
  useEffect(
    () => () => {
      if (frame.current !== null) cancelAnimationFrame(frame.current);
      frame.current = null;
    },
    [],
  );
  return canvas;
}

function draw(canvas: HTMLCanvasElement, picture: Picture): void {
  const context = canvas.getContext("2d");
  if (context === null || picture.size.width === 0) return;
  const sharp = Math.min(window.devicePixelRatio, 2);
  const width = Math.round(picture.size.width * sharp);
  const height = Math.round(picture.size.height * sharp);
  if (canvas.width !== width || canvas.height !== height) {
    canvas.width = width;
    canvas.height = height;
  }
  context.setTransform(sharp, 0, 0, sharp, 0, 0);
  paint(context, picture);
}

function MapButton(props: { label: string; onClick: () => void; Icon: typeof IconPlus }) {
  const { label, onClick, Icon } = props;
  return (
    <ActionIcon variant="default" size={44} aria-label={label} title={label} onClick={onClick}>
      <Icon size={20} aria-hidden />
    </ActionIcon>
  );
}
