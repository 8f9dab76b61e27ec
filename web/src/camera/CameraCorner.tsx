import { Button, NativeSelect } from "@mantine/core";
import { IconArrowsMaximize, IconArrowsMinimize, IconCamera, IconX } from "@tabler/icons-react";
import { useState } from "react";
import { useRobot } from "../state/RobotContext";
import { memoInLanguage } from "../texts/memoInLanguage";
import { t } from "../texts/text";
import { told } from "../texts/told";
import { IconButton } from "../ui/controls/IconButton";
import classes from "./Camera.module.css";
import { pictureAge } from "./cameraText";
import { useCameraFeed } from "./useCameraFeed";
import type { CameraTool } from "./useCameraTool";

interface Props {
  tool: CameraTool;
  /** The scene is covered, and what is in its corner with it. */
  covered: boolean;
}

/** What a camera of the robot sees: a button in the corner of the scene, a picture, a large one. */
export function CameraCorner({ tool, covered }: Props) {
  const { state } = useRobot();
  const topics = state?.cameras.map(({ topic }) => topic) ?? [];
  if (tool.open) return <Camera tool={tool} topics={topics} covered={covered} />;
  if (topics.length === 0) return null;
  return <Opener onOpen={tool.toggle} />;
}

const Opener = memoInLanguage(function Opener({ onOpen }: { onOpen: () => void }) {
  return (
    <Button
      className={classes.opener}
      size="compact-md"
      variant="default"
      leftSection={<IconCamera size={18} aria-hidden />}
      title={t("What the robot's camera sees (C)")}
      onClick={onOpen}
      data-testid="camera-open"
    >
      {t("Camera")}
    </Button>
  );
});

function Camera({ tool, topics, covered }: Props & { topics: string[] }) {
  const [topic, setTopic] = useState<string | null>(null);
  // The first one that is there; and it stays: its driver may be restarting, and who steers by the
  // picture is not shown another one.
  if (topic === null && topics[0] !== undefined) setTopic(topics[0]);
  const listed = topic === null || topics.includes(topic) ? topics : [topic, ...topics];
  const feed = useCameraFeed(topic, tool.large, !covered);
  const { text, stale } = pictureAge(feed.age, feed.waited);
  const problem = told(feed.problem);
  const wrong = problem !== "" ? problem : stale ? text : null;
  return (
    <section
      className={classes.card}
      data-large={tool.large || undefined}
      data-testid="camera-card"
      aria-label={t("Camera")}
    >
      <header className={classes.head}>
        {listed.length > 1 ? (
          <NativeSelect
            className={classes.choice}
            size="xs"
            aria-label={t("Which camera")}
            data-testid="camera-choice"
            data={listed}
            value={topic ?? ""}
            onChange={(event) => setTopic(event.currentTarget.value)}
          />
        ) : (
          <span className={classes.name}>{topic ?? t("Camera")}</span>
        )}
        <IconButton
          label={tool.large ? t("Smaller picture") : t("Larger picture")}
          onClick={tool.resize}
          Icon={tool.large ? IconArrowsMinimize : IconArrowsMaximize}
        />
        <IconButton label={t("Close the camera")} onClick={tool.toggle} Icon={IconX} />
      </header>
      <div className={classes.picture} data-stale={stale || undefined}>
        {feed.picture !== "" && topic !== null && (
          <img
            src={feed.picture}
            alt={t("What {topic} shows", { topic })}
            data-testid="camera-picture"
            data-width={feed.width}
          />
        )}
      </div>
      {/* The age changes all the time: whoever hears the page is told once that it is stale. */}
      <span role="status" className="visually-hidden">
        {problem || (stale ? t("The camera shows no new picture.") : "")}
      </span>
      <p className={classes.told} data-testid="camera-told" data-wrong={wrong !== null}>
        {topic === null
          ? t("No camera of this robot shows pictures now.")
          : wrong === null
            ? text
            : `▲ ${wrong}`}
      </p>
    </section>
  );
}
