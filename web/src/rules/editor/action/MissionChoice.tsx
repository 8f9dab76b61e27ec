import { useMissions } from "../../../missions/useMissions";
import { Choice } from "../../../ui/controls/Choice";

interface Props {
  mission: string;
  onChange: (mission: string) => void;
}

/** One of the robot's missions, by its name: a rule goes on meaning that name. */
export function MissionChoice({ mission, onChange }: Props) {
  const { list } = useMissions();
  const names = (list?.missions ?? []).map(({ name }) => name);
  return (
    <Choice
      label="Mission"
      searchable
      placeholder={names.length === 0 ? "None is saved yet" : "Choose a mission"}
      data={mission === "" || names.includes(mission) ? names : [...names, mission]}
      value={mission === "" ? null : mission}
      onChange={onChange}
    />
  );
}
