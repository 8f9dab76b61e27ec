import { answer, CHANGE_MS, http, QUICK_MS, within } from "./http";
import type { Mission, MissionRun, MissionSave, RunVerb } from "./types";

export const listMissions = (signal: AbortSignal) =>
  answer(http.GET("/api/missions", { signal: within(QUICK_MS, signal) }));

export const saveMission = (mission: MissionSave) =>
  answer(http.POST("/api/missions", { body: mission, signal: within(CHANGE_MS) }));

/** Changes the mission as it was looked at; refused when somebody was faster. */
export const editMission = (before: Mission, mission: MissionSave) =>
  answer(
    http.PUT("/api/missions/{mission_id}", {
      params: { path: { mission_id: before.id } },
      body: { ...mission, version: before.version },
      signal: within(CHANGE_MS),
    }),
  );

export const deleteMission = (mission: Mission) =>
  answer(
    http.DELETE("/api/missions/{mission_id}", {
      params: { path: { mission_id: mission.id }, query: { version: mission.version } },
      signal: within(CHANGE_MS),
    }),
  );

export const restoreMission = (mission: Mission) =>
  answer(
    http.POST("/api/missions/{mission_id}/restore", {
      params: { path: { mission_id: mission.id } },
      signal: within(CHANGE_MS),
    }),
  );

/** Begins it, or lets it wait for its turn. */
export const startMission = (mission: Mission) =>
  answer(
    http.POST("/api/missions/{mission_id}/start", {
      params: { path: { mission_id: mission.id } },
      body: { version: mission.version },
      signal: within(CHANGE_MS),
    }),
  );

export const steerMission = (run: MissionRun, verb: RunVerb) =>
  answer(
    http.POST("/api/missions/run/{number}/{verb}", {
      params: { path: { number: run.number, verb } },
      body: { step: run.step },
      signal: within(CHANGE_MS),
    }),
  );

export const startNextMission = () =>
  answer(http.POST("/api/missions/queue/next", { signal: within(CHANGE_MS) }));

export const unqueueMission = (number: number) =>
  answer(
    http.DELETE("/api/missions/queue/{number}", {
      params: { path: { number } },
      signal: within(CHANGE_MS),
    }),
  );
