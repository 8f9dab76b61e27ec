import { Button } from "@mantine/core";
import { IconArrowLeft } from "@tabler/icons-react";
import type { ReactNode } from "react";
import page from "../../ui/page.module.css";

interface Props {
  title: string;
  /** Where the way back leads. */
  back: string;
  onBack: () => void;
  testId?: string;
  children?: ReactNode;
}

/** The head of a page that one came to from another. */
export function PageTitle({ title, back, onBack, testId, children }: Props) {
  return (
    <div className={page.title}>
      <Button
        variant="subtle"
        px="xs"
        leftSection={<IconArrowLeft size={16} aria-hidden />}
        data-testid={testId}
        onClick={onBack}
      >
        {back}
      </Button>
      <h2>{title}</h2>
      {children}
    </div>
  );
}
