import { Button } from "@mantine/core";
import type { ReactNode } from "react";
import { ErrorBoundary, type FallbackProps } from "react-error-boundary";
import { stopRobot } from "../api/client";
import { OpenStop } from "../stop/OpenStop";
import { t } from "../texts/text";
import classes from "./PageFailed.module.css";

/** The whole page; where it fails, what is left of it says so and has a STOP of its own. */
export function WithStopLeft({ children }: { children: ReactNode }) {
  return <ErrorBoundary FallbackComponent={PageFailed}>{children}</ErrorBoundary>;
}

function PageFailed({ error }: FallbackProps) {
  return (
    <>
      <main className={classes.page} data-testid="page-failed">
        <h1>{t("The page has failed")}</h1>
        <p>{t("The robot goes on with what it does. STOP works.")}</p>
        <Button onClick={() => location.reload()} data-testid="reload">
          {t("Reload the page")}
        </Button>
        <p className={classes.why}>{String(error)}</p>
      </main>
      <OpenStop send={stopRobot} always />
    </>
  );
}
