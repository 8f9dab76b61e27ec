import { answer, CHANGE_MS, http, QUICK_MS, within } from "./http";
import type { Zone, ZoneSave, ZoneSketch } from "./types";

export const listZones = (signal: AbortSignal) =>
  answer(http.GET("/api/zones", { signal: within(QUICK_MS, signal) }));

/** Has a zone looked at, and shown, that is being drawn; nothing is kept. */
export const sketchZone = (sketch: ZoneSketch, signal: AbortSignal) =>
  answer(http.POST("/api/zones/sketch", { body: sketch, signal: within(QUICK_MS, signal) }));

export const saveZone = (zone: ZoneSave) =>
  answer(http.POST("/api/zones", { body: zone, signal: within(CHANGE_MS) }));

/** Makes the zone that was looked at another one; refused when somebody was faster. */
export const editZone = (before: Zone, zone: ZoneSave) =>
  answer(
    http.PUT("/api/zones/{zone_id}", {
      params: { path: { zone_id: before.id } },
      body: { ...zone, version: before.version },
      signal: within(CHANGE_MS),
    }),
  );

export const deleteZone = (zone: Zone) =>
  answer(
    http.DELETE("/api/zones/{zone_id}", {
      params: { path: { zone_id: zone.id }, query: { version: zone.version } },
      signal: within(CHANGE_MS),
    }),
  );

export const restoreZone = (zone: Zone) =>
  answer(
    http.POST("/api/zones/{zone_id}/restore", {
      params: { path: { zone_id: zone.id } },
      signal: within(CHANGE_MS),
    }),
  );
