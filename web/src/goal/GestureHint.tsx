import { Button } from "@mantine/core";
import { IconKeyboard, IconX } from "@tabler/icons-react";
import type { ReactNode } from "react";
import { t } from "../texts/text";
import { GestureBar } from "./GestureBar";
import classes from "./Goal.module.css";

interface Props {
  /** Names its elements. */
  name: string;
  tool: { typing: boolean; type: (open: boolean) => void; toggle: () => void };
  children: ReactNode;
}

/** What the hand can do while a tool of the scene is on, and the ways without a hand on it. */
export function GestureHint({ name, tool, children }: Props) {
  return (
    <GestureBar testId={`${name}-bar`}>
      {children}
      <span className={classes.hintActions}>
        <Button
          size="compact-md"
          variant="default"
          leftSection={<IconKeyboard size={18} aria-hidden />}
          onClick={() => tool.type(!tool.typing)}
          data-testid={`${name}-type`}
        >
          {t("Type coordinates")}
        </Button>
        <Button
          size="compact-md"
          variant="default"
          leftSection={<IconX size={18} aria-hidden />}
          onClick={tool.toggle}
        >
          {t("Done")}
        </Button>
      </span>
    </GestureBar>
  );
}
