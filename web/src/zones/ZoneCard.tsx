import { Button, SegmentedControl, Textarea, TextInput } from "@mantine/core";
import { IconArrowBackUp, IconKeyboard } from "@tabler/icons-react";
import { useMutation } from "@tanstack/react-query";
import { type FormEvent, useState } from "react";
import { editZone, saveZone } from "../api/zonesClient";
import { GestureBar } from "../goal/GestureBar";
import { nameProblem } from "../places/placeText";
import { t } from "../texts/text";
import { told } from "../texts/told";
import { fieldText, speedUnit, typed as typedIn, units } from "../texts/units";
import { broughtIntoView } from "../ui/broughtIntoView";
import { Problem } from "../ui/Problem";
import type { ZoneTool } from "./useZoneTool";
import classes from "./Zones.module.css";
import { cornersText, readCorners, readSpeed, shutInText } from "./zoneText";

type Kind = "keep_out" | "speed";

/** A zone that is being drawn: first its corners, on a floor that is seen, then what it is. */
export function ZoneCard({ tool }: { tool: ZoneTool }) {
  const [described, setDescribed] = useState(tool.zone !== null);
  const [typing, setTyping] = useState(false);
  if (described) {
    return <ZoneForm tool={tool} typing={typing} onDraw={() => setDescribed(false)} />;
  }
  const { corners, problem, error, set, leave } = tool;
  const type = () => {
    setTyping(true);
    setDescribed(true);
  };
  return (
    <GestureBar testId="zone-card">
      <span role="status" data-testid="zone-problem">
        {toldOf(tool)}
      </span>
      <ShutIn tool={tool} />
      <Problem error={error} testId="zone-error" />
      <div className={classes.buttons}>
        {corners.length === 0 ? (
          <Button
            size="compact-md"
            variant="default"
            leftSection={<IconKeyboard size={18} aria-hidden />}
            onClick={type}
            data-testid="zone-type"
          >
            {t("Type corners")}
          </Button>
        ) : (
          <>
            <Button
              size="compact-md"
              disabled={problem !== ""}
              onClick={() => setDescribed(true)}
              data-testid="zone-next"
            >
              {t("Next")}
            </Button>
            <Button
              size="compact-md"
              variant="default"
              leftSection={<IconArrowBackUp size={18} aria-hidden />}
              onClick={() => set(corners.slice(0, -1))}
            >
              {t("Remove last corner")}
            </Button>
          </>
        )}
        <Button size="compact-md" variant="default" onClick={leave} data-testid="zone-cancel">
          {t("Cancel")}
        </Button>
      </div>
    </GestureBar>
  );
}

const toldOf = ({ corners, problem }: ZoneTool): string =>
  corners.length === 0
    ? t("Drag a rectangle on the floor, or tap corner after corner.")
    : told(problem ?? "") || t("{n} corners.", { n: corners.length });

/** What a new speed zone begins with, m/s: a round figure in either unit. */
const standardSpeed = (): number => (units.get() === "metric" ? 0.3 : typedIn(1));

/** A zone may be drawn around the robot, or a place that it is to go to: not unseen. */
function ShutIn({ tool }: { tool: ZoneTool }) {
  const text = shutInText(tool.inside.robot, tool.inside.places);
  return text === null ? null : (
    <p className={classes.warned} role="status" data-testid="zone-shuts-in">
      ▲ {text}
    </p>
  );
}

interface FormProps {
  tool: ZoneTool;
  /** Whether the corners are typed. */
  typing: boolean;
  /** Goes back to the floor. */
  onDraw: () => void;
}

/** What the zone asks for, its name, and its corners as numbers. */
function ZoneForm({ tool, typing, onDraw }: FormProps) {
  const { zone, corners, problem, error, set, leave } = tool;
  const [kind, setKind] = useState<Kind>(zone?.kind ?? "keep_out");
  const [name, setName] = useState(zone?.name ?? "");
  const [speed, setSpeed] = useState(fieldText(zone?.speed || standardSpeed()));
  const [typed, setTyped] = useState<string | null>(typing ? cornersText(corners) : null);
  const [asked, setAsked] = useState(false);
  const save = useMutation({
    mutationFn: () => {
      const body = {
        name: name.trim(),
        kind,
        speed: kind === "speed" ? readSpeed(speed) : null,
        corners: corners.map(([x, y]): [number, number] => [x, y]),
      };
      return zone === null ? saveZone(body) : editZone(zone, body);
    },
    onSuccess: leave,
  });
  const wrong = {
    name: nameProblem(name, "zone"),
    speed:
      kind === "speed" && readSpeed(speed) === null
        ? t("A number of {unit} above 0", { unit: speedUnit() })
        : null,
    corners: typed === null ? null : readCorners(typed).problem,
  };
  const submit = (event: FormEvent) => {
    event.preventDefault();
    setAsked(true);
    if (problem === "" && Object.values(wrong).every((each) => each === null)) save.mutate();
  };
  const type = (text: string) => {
    setTyped(text);
    const read = readCorners(text);
    if (read.problem === null) set(read.corners);
  };
  return (
    <form
      ref={broughtIntoView}
      className={classes.card}
      onSubmit={submit}
      aria-label={zone === null ? t("New zone") : t("Change {name}", { name: zone.name })}
      noValidate
      data-testid="zone-card"
    >
      <SegmentedControl
        fullWidth
        aria-label={t("What the zone asks for")}
        data={[
          { value: "keep_out", label: t("Keep out") },
          { value: "speed", label: t("Speed limit") },
        ]}
        value={kind}
        onChange={(next) => setKind(next === "speed" ? "speed" : "keep_out")}
        data-testid="zone-kind"
      />
      <div className={classes.fields}>
        <TextInput
          label={t("Name")}
          value={name}
          autoFocus={!typing}
          autoComplete="off"
          error={asked ? wrong.name : null}
          onChange={(event) => setName(event.currentTarget.value)}
          data-testid="zone-name"
        />
        {kind === "speed" && (
          <TextInput
            label={t("At most ({unit})", { unit: speedUnit() })}
            inputMode="decimal"
            value={speed}
            error={asked ? wrong.speed : null}
            onChange={(event) => setSpeed(event.currentTarget.value)}
            data-testid="zone-speed"
          />
        )}
      </div>
      <p className={classes.told} role="status" data-testid="zone-problem">
        {toldOf(tool)}
      </p>
      {kind === "keep_out" && <ShutIn tool={tool} />}
      {typed !== null && (
        <Textarea
          label={
            units.get() === "metric"
              ? t("Corners: x, y in metres, a line each")
              : t("Corners: x, y in feet, a line each")
          }
          autosize
          autoFocus={typing}
          minRows={4}
          maxRows={8}
          value={typed}
          error={wrong.corners}
          onChange={(event) => type(event.currentTarget.value)}
          data-testid="zone-corners"
        />
      )}
      <Problem error={error ?? save.error} testId="zone-error" />
      <div className={classes.buttons}>
        <Button
          type="submit"
          size="md"
          loading={save.isPending}
          disabled={problem !== ""}
          data-testid="zone-save"
        >
          {t("Save")}
        </Button>
        <Button variant="default" size="md" onClick={leave} data-testid="zone-leave">
          {t("Cancel")}
        </Button>
        <Button
          variant="subtle"
          size="compact-md"
          leftSection={<IconArrowBackUp size={18} aria-hidden />}
          onClick={onDraw}
          data-testid="zone-draw"
        >
          {t("Draw")}
        </Button>
        {typed === null && (
          <Button
            variant="subtle"
            size="compact-md"
            leftSection={<IconKeyboard size={18} aria-hidden />}
            onClick={() => setTyped(cornersText(corners))}
            data-testid="zone-type"
          >
            {t("Type corners")}
          </Button>
        )}
      </div>
    </form>
  );
}
