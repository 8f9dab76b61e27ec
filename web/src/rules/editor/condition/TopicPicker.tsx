import { useMemo } from "react";
import type { GraphTopic } from "../../../api/ruleTypes";
import { Choice } from "../../../ui/controls/Choice";
import { bare, slashed, title } from "../../model/actions";
import { topicOf } from "../../model/signals";
import { useEditor } from "../form/EditorContext";

interface Props {
  topic: string;
  type: string;
  onChange: (name: string) => void;
}

/** The topics on the robot's graph, the health of its components first. */
export function TopicPicker({ topic, type, onChange }: Props) {
  const { graph } = useEditor();
  const data = useMemo(() => {
    const topics = [...(graph?.topics ?? [])].sort((a, b) => a.name.localeCompare(b.name));
    const groups: [string, GraphTopic[]][] = [
      ["Sensors and messages", topics.filter((each) => each.component === "")],
      ["Health of components", topics.filter((each) => each.component !== "")],
    ];
    const listed = groups
      .filter(([, members]) => members.length > 0)
      .map(([group, members]) => ({
        group,
        items: members.map((each) => ({
          value: bare(each.name),
          label:
            each.component === ""
              ? slashed(each.name)
              : `${title(each.component)}: ${slashed(each.name)}`,
        })),
      }));
    const known = topic === "" || topicOf(graph, topic) !== null;
    return known
      ? listed
      : [
          ...listed,
          { group: "Not on the graph now", items: [{ value: topic, label: slashed(topic) }] },
        ];
  }, [graph, topic]);
  const chosen = topicOf(graph, topic);
  return (
    <Choice
      label="of topic"
      placeholder="Choose a topic"
      searchable
      data={data}
      value={topic === "" ? null : topic}
      onChange={onChange}
      maxDropdownHeight={320}
      nothingFoundMessage="No such topic on the graph"
      data-testid="topic-picker"
      title={type === "" ? undefined : `${type}${pace(chosen)}`}
    />
  );
}

/** How fast messages come, or for how long none has; nothing where the monitor does not listen. */
function pace(topic: GraphTopic | null): string {
  if (topic?.rate != null) return `, ${topic.rate.toPrecision(3)} Hz`;
  return topic?.silent == null ? "" : `, silent for ${Math.round(topic.silent)} s`;
}
