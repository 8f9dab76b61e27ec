let known: boolean | null = null;

/** Whether this browser draws in three dimensions; asked once. */
export function drawsWebGl(): boolean {
  known ??= document.createElement("canvas").getContext("webgl2") !== null;
  return known;
}
