import { Menu, UnstyledButton } from "@mantine/core";
import { useMediaQuery } from "@mantine/hooks";
import { IconCheck, IconStack2 } from "@tabler/icons-react";
import type { LayerKey } from "../api/types";
import { type Phrase, t } from "../texts/text";
import { LOW } from "../ui/screen";
import { ExtraLayers } from "./ExtraLayers";
import classes from "./Layers.module.css";
import type { Flat } from "./useFlat";
import type { ViewHandle } from "./useView";

const LAYERS: [LayerKey, Phrase][] = [
  ["map", "Map"],
  ["local_map", "Local map"],
  ["path", "Path"],
  ["scan", "Laser scan"],
  ["robot", "Robot"],
  ["goal", "Goal"],
  ["trail", "Trail"],
  ["places", "Places"],
  ["zones", "Zones"],
];

interface Props {
  scene: ViewHandle;
  flat: Flat;
  open: boolean;
  onOpen: (open: boolean) => void;
  className: string | undefined;
}

/** Which parts of the scene are drawn; stays open while several are switched. */
export function LayersMenu({ scene, flat, open, onOpen, className }: Props) {
  const { view, toggleLayer, toggleExtra } = scene;
  const low = useMediaQuery(LOW, false, { getInitialValueInEffect: false });
  return (
    <Menu
      opened={open}
      onChange={onOpen}
      position={low ? "bottom-start" : "right-start"}
      closeOnItemClick={false}
      width={260}
    >
      <Menu.Target>
        <UnstyledButton
          className={className}
          disabled={view === null}
          data-testid="layers"
          title={t("What the scene shows (L)")}
        >
          <IconStack2 size={22} aria-hidden />
          <span>{t("Layers")}</span>
        </UnstyledButton>
      </Menu.Target>
      <Menu.Dropdown aria-label={t("Layers")} className={classes.dropdown}>
        {LAYERS.map(([key, label]) => {
          const on = view?.layers[key] ?? false;
          return (
            <Menu.CheckboxItem
              key={key}
              checked={on}
              checkIcon={<IconCheck size={18} aria-hidden />}
              data-testid={`layer-${key}`}
              onChange={() => toggleLayer(key)}
              mih={44}
            >
              {t(label)}
            </Menu.CheckboxItem>
          );
        })}
        {open && view !== null && <ExtraLayers view={view} onToggle={toggleExtra} />}
        <Menu.Divider />
        <Menu.CheckboxItem
          checked={flat.flat}
          checkIcon={<IconCheck size={18} aria-hidden />}
          disabled={!flat.choice}
          data-testid="flat"
          onChange={flat.toggle}
          mih={44}
        >
          {t("Flat map, for weak devices")}
        </Menu.CheckboxItem>
      </Menu.Dropdown>
    </Menu>
  );
}
