import { Button, Menu, UnstyledButton } from "@mantine/core";
import { useMutation } from "@tanstack/react-query";
import { useState } from "react";
import type { Alarm } from "../../api/ruleTypes";
import { acknowledgeAlarm, shelveAlarm } from "../../api/timelineClient";
import { useSession } from "../../session/SessionContext";
import { useNow } from "../../state/RobotContext";
import { whenText } from "../../texts/dates";
import { type Phrase, t } from "../../texts/text";
import { Band } from "../../ui/Band";
import { Problem } from "../../ui/Problem";
import { useLive, useRules } from "../context/RulesContext";
import { leftText, ruleName } from "../model/words";
import classes from "./Alarms.module.css";

const LOUD = new Set(["error", "critical"]);
const SHELVES: { seconds: number; label: Phrase }[] = [
  { seconds: 900, label: "for 15 minutes" },
  { seconds: 3600, label: "for an hour" },
  { seconds: 8 * 3600, label: "for 8 hours" },
];

/** Alarms that rules have raised, until a rule clears them; loud until somebody has seen them. */
export function AlarmsBand() {
  const { rules } = useLive();
  const now = useNow();
  const [open, setOpen] = useState(false);
  const alarms = rules?.alarms ?? [];
  const away = alarms.filter((alarm) => alarm.shelved_until > now);
  return (
    <>
      {alarms
        .filter((alarm) => open || alarm.shelved_until <= now)
        .map((alarm) => (
          <AlarmBand key={alarm.name} alarm={alarm} now={now} />
        ))}
      {away.length > 0 && (
        <Band
          tone="notice"
          title={t("{n, plural, one {One alarm is shelved} other {# alarms are shelved}}", {
            n: away.length,
          })}
          testId="alarms-away"
          action={
            <UnstyledButton
              className={classes.more}
              aria-expanded={open}
              data-testid="alarms-away-show"
              onClick={() => setOpen(!open)}
            >
              {open ? t("Hide") : t("Look")}
            </UnstyledButton>
          }
        />
      )}
    </>
  );
}

function AlarmBand({ alarm, now }: { alarm: Alarm; now: number }) {
  const { session } = useSession();
  const { view } = useRules();
  const rule = view?.table.rules.find(({ id }) => id === alarm.rule_id);
  const seen = useMutation({ mutationFn: () => acknowledgeAlarm(alarm) });
  const away = useMutation({ mutationFn: (seconds: number) => shelveAlarm(alarm.name, seconds) });
  const shelved = alarm.shelved_until > now;
  const calm = alarm.acknowledged_by !== "" || shelved;
  const may = session.role !== "viewer";
  const told = [
    alarm.acknowledged_by !== "" && t("Acknowledged by {by}", { by: alarm.acknowledged_by }),
    shelved &&
      t("Shelved by {by}, for {left} more", {
        by: alarm.shelved_by || t("somebody"),
        left: leftText(alarm.shelved_until - now),
      }),
    alarm.text,
    rule !== undefined && t('Raised by "{name}"', { name: ruleName(rule) }),
    alarm.count > 1
      ? `${whenText(alarm.since, now)}, ${t("{count} times", { count: alarm.count })}`
      : whenText(alarm.since, now),
  ];
  return (
    <Band
      brief={calm}
      tone={LOUD.has(alarm.severity) && !calm ? "failed" : "notice"}
      title={t("Alarm: {name}", { name: alarm.name })}
      testId="alarm-band"
      action={
        may && (
          <span className={classes.buttons}>
            {!calm && (
              <Button
                size="compact-sm"
                variant="default"
                loading={seen.isPending}
                data-testid="alarm-acknowledge"
                onClick={() => seen.mutate()}
              >
                {t("Acknowledge")}
              </Button>
            )}
            {shelved ? (
              <Button
                size="compact-sm"
                variant="default"
                loading={away.isPending}
                data-testid="alarm-unshelve"
                onClick={() => away.mutate(0)}
              >
                {t("Show again")}
              </Button>
            ) : (
              <Menu position="bottom-end" withinPortal>
                <Menu.Target>
                  <Button
                    size="compact-sm"
                    variant="default"
                    loading={away.isPending}
                    data-testid="alarm-shelve"
                  >
                    {t("Shelve")}
                  </Button>
                </Menu.Target>
                <Menu.Dropdown>
                  {SHELVES.map(({ seconds, label }) => (
                    <Menu.Item
                      key={seconds}
                      data-testid={`alarm-shelve-${seconds}`}
                      onClick={() => away.mutate(seconds)}
                    >
                      {t(label)}
                    </Menu.Item>
                  ))}
                </Menu.Dropdown>
              </Menu>
            )}
          </span>
        )
      }
    >
      {told.filter(Boolean).join(" · ")}
      <Problem error={seen.error ?? away.error} />
    </Band>
  );
}
