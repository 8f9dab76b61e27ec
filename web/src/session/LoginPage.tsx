import { Anchor, Button, Code, PasswordInput, Text, TextInput, Title } from "@mantine/core";
import { useMutation, useQuery } from "@tanstack/react-query";
import { type FormEvent, useState } from "react";
import { login, waysIn } from "../api/client";
import type { Session } from "../api/types";
import { rich, t } from "../texts/text";
import { told } from "../texts/told";
import { Mark } from "../ui/Mark";
import classes from "./LoginPage.module.css";

interface Props {
  /** Why the page asks, when it is not the first time (a refused link, an ended session). */
  notice: string | null;
  onLogin: (session: Session) => void;
}

/** Asks for name and password where there are accounts, else for a token. */
export function LoginPage({ notice, onLogin }: Props) {
  const ways = useQuery({ queryKey: ["ways in"], queryFn: waysIn, retry: false });
  const [asked, setAsked] = useState<"name" | "token" | null>(null);
  const [token, setToken] = useState("");
  const [user, setUser] = useState("");
  const [password, setPassword] = useState("");
  const byName = asked === null ? ways.data?.accounts === true : asked === "name";
  const enter = useMutation({
    mutationFn: () => login(byName ? { user, password } : { token: tokenFrom(token) }),
    onSuccess: onLogin,
  });
  const { error } = enter;
  const problem = error === null ? null : `${told(error.title)} ${told(error.remedy)}`;
  const complete = byName ? user.trim() !== "" && password !== "" : token.trim() !== "";

  const submit = (event: FormEvent) => {
    event.preventDefault();
    enter.mutate();
  };
  const ask = (way: "name" | "token") => {
    setAsked(way);
    enter.reset();
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
        {ways.isPending ? null : byName ? (
          <>
            <TextInput
              label={t("Name")}
              autoComplete="username"
              autoCapitalize="none"
              autoFocus
              data-testid="login-name"
              size="md"
              value={user}
              onChange={(event) => setUser(event.currentTarget.value)}
            />
            <PasswordInput
              label={t("Password")}
              autoComplete="current-password"
              data-testid="login-password"
              size="md"
              value={password}
              onChange={(event) => setPassword(event.currentTarget.value)}
              error={problem}
              errorProps={{ role: "alert", "data-testid": "login-error" }}
            />
          </>
        ) : (
          <PasswordInput
            label={t("Token")}
            description={t(
              "From the address that the console printed when it started; the whole address works too.",
            )}
            autoComplete="off"
            autoFocus
            data-testid="login-token"
            size="md"
            value={token}
            onChange={(event) => setToken(event.currentTarget.value)}
            error={problem}
            errorProps={{ role: "alert", "data-testid": "login-error" }}
          />
        )}
        <Button
          type="submit"
          size="md"
          loading={enter.isPending}
          disabled={!complete}
          data-testid="login-submit"
        >
          {t("Open the console")}
        </Button>
        {byName ? (
          <Text size="sm" className={classes.help}>
            {rich(
              "No account, or no password any more? Whoever looks after the robot gives you one: <c>kompass-console users</c>.",
              { c: (parts) => <Code>{parts}</Code> },
            )}
            {ways.data?.tokens && (
              <>
                {" "}
                <Anchor component="button" type="button" size="sm" onClick={() => ask("token")}>
                  {t("Log in with a token")}
                </Anchor>
              </>
            )}
          </Text>
        ) : (
          <Text size="sm" className={classes.help}>
            {rich(
              "No token at hand? On the robot, look for the line with <c>#token=</c> in the output of <c>kompass-console</c>, or start it again for a new one.",
              { c: (parts) => <Code>{parts}</Code> },
            )}
            {ways.data?.accounts && (
              <>
                {" "}
                <Anchor component="button" type="button" size="sm" onClick={() => ask("name")}>
                  {t("Log in by name")}
                </Anchor>
              </>
            )}
          </Text>
        )}
      </form>
    </main>
  );
}

/** People paste the whole printed address as often as the token alone. */
export function tokenFrom(text: string): string {
  const trimmed = text.trim();
  return /[#&]token=([^&\s]+)/.exec(trimmed)?.[1] ?? trimmed;
}
