import { Button } from "@mantine/core";
import type { ReactNode } from "react";
import { ErrorBoundary, type FallbackProps } from "react-error-boundary";
import { t } from "../texts/text";
import classes from "./Part.module.css";

/** A part of the page that fails by itself: the others, and STOP, stay. */
export function Part({ children }: { children: ReactNode }) {
  return <ErrorBoundary FallbackComponent={Failed}>{children}</ErrorBoundary>;
}

function Failed({ error, resetErrorBoundary }: FallbackProps) {
  return (
    <section className={classes.failed} role="alert" data-testid="part-failed">
      <p>{t("This part of the page has failed: {why}.", { why: String(error) })}</p>
      <Button variant="default" size="compact-md" onClick={resetErrorBoundary}>
        {t("Show it again")}
      </Button>
    </section>
  );
}
