import { ActionIcon } from "@mantine/core";
import type { Icon } from "@tabler/icons-react";

interface Props {
  /** What it does, for who cannot see it. */
  label: string;
  /** The same in fewer words, where the place says the rest. */
  title?: string;
  disabled?: boolean;
  onClick: () => void;
  Icon: Icon;
}

/** A button that is a picture only. */
export function IconButton({ label, title = label, disabled = false, onClick, Icon }: Props) {
  return (
    <ActionIcon
      variant="subtle"
      color="gray"
      aria-label={label}
      title={title}
      disabled={disabled}
      onClick={onClick}
    >
      <Icon size={16} aria-hidden />
    </ActionIcon>
  );
}
