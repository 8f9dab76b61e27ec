import { useComputedColorScheme, useMantineColorScheme } from "@mantine/core";

export type ThemeChoice = "auto" | "light" | "dark";

const NEXT: Record<ThemeChoice, ThemeChoice> = { auto: "light", light: "dark", dark: "auto" };

/** The chosen theme (kept in this browser) and what it comes to here and now. */
export function useTheme(): { choice: ThemeChoice; dark: boolean; cycle: () => void } {
  const { colorScheme, setColorScheme } = useMantineColorScheme();
  const computed = useComputedColorScheme("light", { getInitialValueInEffect: false });
  return {
    choice: colorScheme,
    dark: computed === "dark",
    cycle: () => setColorScheme(NEXT[colorScheme]),
  };
}
