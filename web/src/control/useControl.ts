import { useSession } from "../session/SessionContext";
import { useRobot } from "../state/RobotContext";
import { type ControlView, controlView } from "./controlText";

/** Control of the robot as this page sees it; null until the console has said so, and while it is
 * not heard. */
export function useControl(): ControlView | null {
  const { state, elapsed, frozen } = useRobot();
  const { session } = useSession();
  return state === null || frozen ? null : controlView(state.control, session, elapsed);
}
