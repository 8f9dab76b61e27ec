import {
  createTheme,
  type MantineColorsTuple,
  Menu,
  MultiSelect,
  Select,
  useComputedColorScheme,
  useMantineColorScheme,
} from "@mantine/core";
import { useColorScheme } from "@mantine/hooks";

/** The one accent: shade 7 carries white text, shade 4 stands on dark ground, both above 4.5:1. */
const blue: MantineColorsTuple = [
  "#edf4ff",
  "#d9e7fb",
  "#b4cff5",
  "#93bbf2",
  "#74a8ee",
  "#4f8ee3",
  "#2f74d0",
  "#1f5fbf",
  "#184d9e",
  "#113c7d",
];

/** Mantine's dark greys, in the slate of the page (styles.css). */
const slate: MantineColorsTuple = [
  "#e6eaee",
  "#c3cbd3",
  "#a3aeb9",
  "#7d8994",
  "#4a5560",
  "#333c45",
  "#272e35",
  "#1e2429",
  "#171c21",
  "#14181c",
];

/** The list itself scrolls: a box for that inside of it would be no option, and is not reached. */
const LIST = {
  withScrollArea: false,
  styles: { options: { maxHeight: "min(340px, 45dvh)", overflowY: "auto" as const } },
};

export const theme = createTheme({
  primaryColor: "kompass",
  primaryShade: { light: 7, dark: 7 },
  colors: { kompass: blue, dark: slate },
  fontFamily: 'system-ui, -apple-system, "Segoe UI", Roboto, "Noto Sans", sans-serif',
  fontFamilyMonospace: 'ui-monospace, "SF Mono", Menlo, Consolas, "DejaVu Sans Mono", monospace',
  fontSizes: { xs: "0.8125rem", sm: "0.875rem", md: "0.875rem", lg: "1rem", xl: "1.125rem" },
  defaultRadius: "md",
  respectReducedMotion: true,
  focusRing: "auto",
  components: {
    // A menu holds its items and nothing else that takes the focus.
    Menu: Menu.extend({ defaultProps: { withInitialFocusPlaceholder: false } }),
    Select: Select.extend({ defaultProps: LIST }),
    MultiSelect: MultiSelect.extend({ defaultProps: LIST }),
  },
});

type ThemeChoice = "auto" | "light" | "dark";

/** From what the system says to its opposite: each press is to be seen. */
const NEXT: Record<"light" | "dark", Record<ThemeChoice, ThemeChoice>> = {
  light: { auto: "dark", dark: "light", light: "auto" },
  dark: { auto: "light", light: "dark", dark: "auto" },
};

/** The chosen theme (kept in this browser) and what it comes to here and now. */
export function useTheme(): { choice: ThemeChoice; dark: boolean; cycle: () => void } {
  const { colorScheme, setColorScheme } = useMantineColorScheme();
  const system = useColorScheme("light", { getInitialValueInEffect: false });
  const computed = useComputedColorScheme("light", { getInitialValueInEffect: false });
  return {
    choice: colorScheme,
    dark: computed === "dark",
    cycle: () => setColorScheme(NEXT[system][colorScheme]),
  };
}
