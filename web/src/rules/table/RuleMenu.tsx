import { ActionIcon, Menu } from "@mantine/core";
import {
  IconArrowDown,
  IconArrowUp,
  IconCopy,
  IconDots,
  IconGhost2,
  IconRotate,
  IconTrash,
} from "@tabler/icons-react";
import { useMutation } from "@tanstack/react-query";
import { resetRule } from "../../api/rulesClient";
import type { Rule, RuleStatus } from "../../api/ruleTypes";
import { duplicateRule, moveRule, putRule, removeRule } from "../changes/draft";
import { useRules } from "../context/RulesContext";
import { useNav } from "../context/RulesNav";
import { ruleName } from "../model/words";

const RESETTABLE = new Set(["used up", "latched", "cooling", "waiting"]);

/** What else can be done with a rule. Everything but the reset goes into the draft. */
export function RuleMenu({ rule, status }: { rule: Rule; status: RuleStatus | null }) {
  const { draft } = useRules();
  const nav = useNav();
  const startAfresh = useMutation({ mutationFn: () => resetRule(rule.id) });
  const { error } = startAfresh;
  const duplicate = () => {
    const table = draft.table;
    if (table === null) return;
    const copy = duplicateRule(table, rule.id);
    draft.edit(() => copy.table);
    nav.go({ at: "edit", id: copy.id });
  };
  const guarded = rule.protected ? "Protected: only the recipe can change it" : undefined;
  return (
    <Menu position="bottom-end" width={240} onOpen={startAfresh.reset}>
      <Menu.Target>
        <ActionIcon
          variant="subtle"
          color="gray"
          size="md"
          aria-label={`More for ${ruleName(rule)}`}
          data-testid="rule-menu"
        >
          <IconDots size={18} aria-hidden />
        </ActionIcon>
      </Menu.Target>
      <Menu.Dropdown>
        <Menu.Item leftSection={<IconCopy size={16} aria-hidden />} onClick={duplicate}>
          Duplicate
        </Menu.Item>
        <Menu.Item
          leftSection={<IconGhost2 size={16} aria-hidden />}
          disabled={rule.protected}
          title={guarded ?? "Evaluated and recorded, without acting"}
          onClick={() => draft.edit((table) => putRule(table, { ...rule, shadow: !rule.shadow }))}
        >
          {rule.shadow ? "Let it act again" : "Shadow: watch only"}
        </Menu.Item>
        <Menu.Item
          leftSection={<IconArrowUp size={16} aria-hidden />}
          onClick={() => draft.edit((table) => moveRule(table, rule.id, -1))}
        >
          Earlier
        </Menu.Item>
        <Menu.Item
          leftSection={<IconArrowDown size={16} aria-hidden />}
          onClick={() => draft.edit((table) => moveRule(table, rule.id, 1))}
        >
          Later
        </Menu.Item>
        {status !== null && RESETTABLE.has(status.state) && (
          <Menu.Item
            leftSection={<IconRotate size={16} aria-hidden />}
            closeMenuOnClick={false}
            onClick={() => startAfresh.mutate()}
          >
            Let it start afresh now
          </Menu.Item>
        )}
        {error !== null && (
          <Menu.Label>
            {error.title} {error.remedy}
          </Menu.Label>
        )}
        <Menu.Divider />
        <Menu.Item
          leftSection={<IconTrash size={16} aria-hidden />}
          disabled={rule.protected}
          title={guarded}
          data-testid="rule-delete"
          onClick={() => draft.edit((table) => removeRule(table, rule.id))}
        >
          Delete
        </Menu.Item>
      </Menu.Dropdown>
    </Menu>
  );
}
