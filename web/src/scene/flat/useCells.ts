import { useEffect, useState } from "react";

const AGAIN_MS = 2000;

/**
 * The picture of a version of the map; the one before until it has come. `missing` while it does not
 * come: it is asked for again then.
 */
export function useCells(version: number | null, theme: "light" | "dark") {
  const [cells, setCells] = useState<HTMLImageElement | null>(null);
  const [missing, setMissing] = useState(false);
  useEffect(() => {
    if (version === null) return setCells(null);
    let retry: number | undefined;
    const image = new Image();
    const source = `/api/map/${version}?theme=${theme}`;
    image.onload = () => {
      setCells(image);
      setMissing(false);
    };
    image.onerror = () => {
      setMissing(true);
      retry = window.setTimeout(() => {
        image.src = source;
      }, AGAIN_MS);
    };
    image.src = source;
    return () => {
      window.clearTimeout(retry);
      image.onload = image.onerror = null;
    };
  }, [version, theme]);
  return { cells, missing };
}
