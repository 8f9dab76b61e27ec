import { Button } from "@mantine/core";
import { IconTrash } from "@tabler/icons-react";
import { useState } from "react";
import type { Condition, Group, TreePath } from "../../../api/ruleTypes";
import { Choice } from "../../../ui/controls/Choice";
import { IconButton } from "../../../ui/controls/IconButton";
import { findingsAt } from "../../changes/findings";
import {
  addAt,
  fieldOf,
  isBlank,
  isGroup,
  nodeAt,
  removeAt,
  replaceAt,
  toggleNot,
} from "../../model/condition";
import { blank } from "../../model/presets";
import { FindingList } from "../../parts/FindingList";
import classes from "../form/Editor.module.css";
import { useEditor } from "../form/EditorContext";
import { LiveLeaf } from "../form/Probe";
import { AddCondition } from "./AddCondition";
import { LeafEditor } from "./LeafEditor";

interface Props {
  /** Which field of the rule this tree is, as findings name it. */
  root: "event.condition" | "event.clear";
  condition: Condition;
  onChange: (condition: Condition) => void;
}

/** A tree of conditions: all of, any of, not, and what is compared at its leaves. */
export function ConditionEditor(props: Props) {
  const { condition, onChange } = props;
  const single = !isGroup(condition);
  // Until somebody has chosen one by hand, an empty condition is a question and no form.
  const [byHand, setByHand] = useState(false);
  if (!byHand && isBlank(condition)) {
    return (
      <div className={classes.tree} data-testid={props.root}>
        <AddCondition
          label="Choose or search: an obstacle, a failure, silence …"
          onAdd={(chosen) => {
            setByHand(true);
            onChange(chosen);
          }}
        />
      </div>
    );
  }
  return (
    <div className={classes.tree} data-testid={props.root}>
      <Node {...props} path={[]} />
      {single && (
        <AddCondition label="And also …" onAdd={(added) => onChange(addAt(condition, [], added))} />
      )}
    </div>
  );
}

function Node(props: Props & { path: TreePath }) {
  const { root, condition: tree, onChange, path } = props;
  const { graph, findings } = useEditor();
  const node = nodeAt(tree, path);
  if (node === null) return null;
  const field = fieldOf(root, tree, path);
  const put = (next: Condition) => onChange(replaceAt(tree, path, next));
  const remove = () => onChange(removeAt(tree, path) ?? blank("compare", graph, null));

  if (node.kind === "not") {
    return (
      <div className={classes.not}>
        <Button
          variant="light"
          size="compact-md"
          aria-label="not: press to take it away"
          title="Take the 'not' away"
          onClick={() => onChange(toggleNot(tree, path))}
        >
          not
        </Button>
        <Node {...props} path={[...path, 0]} />
      </div>
    );
  }
  if (isGroup(node)) {
    return (
      <div className={classes.group}>
        <div className={classes.groupHead}>
          <GroupKind group={node} onChange={put} />
          {path.length > 0 && (
            <Button
              variant="subtle"
              size="compact-md"
              title="True when this group is false"
              onClick={() => onChange(toggleNot(tree, path))}
            >
              Opposite
            </Button>
          )}
          <span className={classes.spring} />
          {path.length > 0 && <Remove what="this group" onClick={remove} />}
        </div>
        {node.conditions.map((_, index) => (
          // biome-ignore lint/suspicious/noArrayIndexKey: a condition is known by its place
          <Node key={index} {...props} path={[...path, index]} />
        ))}
        <AddCondition label="Add condition" onAdd={(added) => onChange(addAt(tree, path, added))} />
      </div>
    );
  }
  return (
    <div className={classes.leaf} data-testid={field}>
      <LeafEditor
        leaf={node}
        now={<LiveLeaf root={root} path={path} />}
        onChange={put}
        tools={
          <>
            <Button
              variant="subtle"
              size="compact-md"
              title="True when this condition is false"
              onClick={() => onChange(toggleNot(tree, path))}
            >
              Opposite
            </Button>
            <Remove what="this condition" onClick={remove} />
          </>
        }
      />
      <FindingList findings={findingsAt(findings, field)} />
    </div>
  );
}

function GroupKind({ group, onChange }: { group: Group; onChange: (group: Group) => void }) {
  return (
    <Choice
      aria-label="How the conditions go together"
      data={[
        { value: "all", label: "All of these" },
        { value: "any", label: "Any of these" },
      ]}
      value={group.kind}
      onChange={(kind) => {
        if (kind === "all" || kind === "any") onChange({ ...group, kind });
      }}
    />
  );
}

function Remove({ what, onClick }: { what: string; onClick: () => void }) {
  return <IconButton label={`Remove ${what}`} title="Remove" Icon={IconTrash} onClick={onClick} />;
}
