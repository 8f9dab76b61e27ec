import { UnstyledButton } from "@mantine/core";
import { IconChevronDown, IconChevronRight } from "@tabler/icons-react";
import { useState } from "react";
import { scenarioAddress } from "../../api/drillsClient";
import type { DrillDrive } from "../../api/drillTypes";
import page from "../../ui/page.module.css";
import { useRules } from "../context/RulesContext";
import classes from "./Drill.module.css";
import { DrivePlayer } from "./DrivePlayer";
import { CHANGE_MARKS, CHANGE_WORDS, faultsText, toldText } from "./drillText";

interface Props {
  drill: string;
  drives: readonly DrillDrive[];
}

/** The drives that differ, the worse ones first, then the others; one is open at a time. */
export function DriveList({ drill, drives }: Props) {
  const { played, setPlayed } = useRules();
  const open = played?.drill === drill ? played.scenario : null;
  const setOpen = (scenario: string | null) =>
    setPlayed(scenario === null ? null : { drill, scenario });
  const [all, setAll] = useState(false);
  const same = drives.filter(({ change }) => change === "same").length;
  const shown = all ? drives : drives.filter(({ change }) => change !== "same");
  return (
    <>
      <ul className={classes.drives}>
        {shown.map((drive) => (
          <li key={drive.name} data-testid={`drive-${drive.name}`}>
            <UnstyledButton
              className={classes.drive}
              aria-expanded={open === drive.name}
              onClick={() => setOpen(open === drive.name ? null : drive.name)}
            >
              <span className={classes.mark} data-change={drive.change} aria-hidden>
                {CHANGE_MARKS[drive.change]}
              </span>
              <span className={classes.what}>
                <span>
                  <strong>{CHANGE_WORDS[drive.change]}</strong>, {faultsText(drive.faults)}
                </span>
                <span className={page.muted}>{toldText(drive)}</span>
              </span>
              {open === drive.name ? (
                <IconChevronDown size={18} aria-hidden />
              ) : (
                <IconChevronRight size={18} aria-hidden />
              )}
            </UnstyledButton>
            {open === drive.name && (
              <>
                <DrivePlayer drill={drill} scenario={drive.name} />
                <a
                  className={page.link}
                  href={scenarioAddress(drill, drive.name)}
                  download
                  data-testid="drive-file"
                >
                  Keep this drive as a scenario file
                </a>
              </>
            )}
          </li>
        ))}
      </ul>
      {same > 0 && (
        <button
          type="button"
          className={page.more}
          data-testid="drives-all"
          onClick={() => setAll(!all)}
        >
          {all ? "Show those that differ only" : `Show the ${same} that went the same, too`}
        </button>
      )}
    </>
  );
}
