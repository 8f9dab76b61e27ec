import { answer, CHANGE_MS, http, QUICK_MS, within } from "./http";
import type { Place, PlaceEdit, PlaceSave } from "./types";

export type PlaceChange = Partial<Omit<PlaceEdit, "version">>;

export const listPlaces = (signal: AbortSignal) =>
  answer(http.GET("/api/places", { signal: within(QUICK_MS, signal) }));

/** Without a pose it is where the robot stands. */
export const savePlace = (place: PlaceSave) =>
  answer(http.POST("/api/places", { body: place, signal: within(CHANGE_MS) }));

/** Changes the place as it was looked at; refused when somebody was faster. */
export const editPlace = (place: Place, change: PlaceChange) =>
  answer(
    http.PATCH("/api/places/{place_id}", {
      params: { path: { place_id: place.id } },
      body: { here: false, to_robot: false, ...change, version: place.version },
      signal: within(CHANGE_MS),
    }),
  );

export const deletePlace = (place: Place) =>
  answer(
    http.DELETE("/api/places/{place_id}", {
      params: { path: { place_id: place.id }, query: { version: place.version } },
      signal: within(CHANGE_MS),
    }),
  );

export const restorePlace = (place: Place) =>
  answer(
    http.POST("/api/places/{place_id}/restore", {
      params: { path: { place_id: place.id } },
      signal: within(CHANGE_MS),
    }),
  );
