import { Button, Code, PasswordInput, Text, Title } from "@mantine/core";
import { useMutation } from "@tanstack/react-query";
import { type FormEvent, useState } from "react";
import { login } from "../api/client";
import type { Session } from "../api/types";
import { Mark } from "../ui/Mark";
import classes from "./LoginPage.module.css";

interface Props {
  /** Why the page asks, when it is not the first time (a refused link, an ended session). */
  notice: string | null;
  onLogin: (session: Session) => void;
}

export function LoginPage({ notice, onLogin }: Props) {
  const [token, setToken] = useState("");
  const enter = useMutation({ mutationFn: () => login(tokenFrom(token)), onSuccess: onLogin });
  const { error } = enter;

  const submit = (event: FormEvent) => {
    event.preventDefault();
    enter.mutate();
  };

  return (
    <main className={classes.page}>
      <form className={classes.card} onSubmit={submit}>
        <div className={classes.brand}>
          <Mark size={28} />
          <Title order={1} size="h3">
            Kompass Console
          </Title>
        </div>
        {notice !== null && error === null && (
          <Text role="status" className={classes.notice}>
            {notice}
          </Text>
        )}
        <PasswordInput
          label="Token"
          description="From the address that the console printed when it started; the whole address works too."
          autoComplete="off"
          autoFocus
          data-testid="login-token"
          size="md"
          value={token}
          onChange={(event) => setToken(event.currentTarget.value)}
          error={error === null ? null : `${error.title} ${error.remedy}`}
          errorProps={{ role: "alert", "data-testid": "login-error" }}
        />
        <Button
          type="submit"
          size="md"
          loading={enter.isPending}
          disabled={token.trim() === ""}
          data-testid="login-submit"
        >
          Open the console
        </Button>
        <Text size="sm" className={classes.help}>
          No token at hand? On the robot, look for the line with <Code>#token=</Code> in the output
          of <Code>kompass-console</Code>, or start it again for a new one.
        </Text>
      </form>
    </main>
  );
}

/** People paste the whole printed address as often as the token alone. */
export function tokenFrom(text: string): string {
  const trimmed = text.trim();
  return /[#&]token=([^&\s]+)/.exec(trimmed)?.[1] ?? trimmed;
}
