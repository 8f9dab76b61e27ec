import { Button } from "@mantine/core";
import { Children, isValidElement, type ReactNode } from "react";
import { ErrorBoundary, type FallbackProps } from "react-error-boundary";
import { t } from "../texts/text";
import classes from "./Parts.module.css";

/** Parts of the page of which each fails by itself: the others, and STOP, stay. */
export function Parts({ children }: { children: ReactNode }) {
  return Children.toArray(children).map((part) => (
    <ErrorBoundary key={isValidElement(part) ? part.key : null} FallbackComponent={Failed}>
      {part}
    </ErrorBoundary>
  ));
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
