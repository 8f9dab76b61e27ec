import { ActionIcon, Menu } from "@mantine/core";
import { IconDownload } from "@tabler/icons-react";
import { exportAddress } from "../../api/rulesClient";

const FORMATS = [
  ["json", "JSON"],
  ["yaml", "YAML"],
  ["python", "Python, for the recipe"],
] as const;

/** The table in force as a file. */
export function ExportMenu() {
  return (
    <Menu position="bottom-end">
      <Menu.Target>
        <ActionIcon
          variant="subtle"
          color="gray"
          size="lg"
          aria-label="Download the rules"
          title="Download the rules"
        >
          <IconDownload size={18} aria-hidden />
        </ActionIcon>
      </Menu.Target>
      <Menu.Dropdown>
        {FORMATS.map(([format, label]) => (
          <Menu.Item
            key={format}
            component="a"
            href={exportAddress(format)}
            download={`rules.${format === "python" ? "py" : format}`}
          >
            {label}
          </Menu.Item>
        ))}
      </Menu.Dropdown>
    </Menu>
  );
}
