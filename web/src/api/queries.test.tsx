import {
  focusManager,
  onlineManager,
  QueryClientProvider,
  useMutation,
} from "@tanstack/react-query";
import { act, cleanup, fireEvent, render, screen } from "@testing-library/react";
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import { noAnswer } from "./errors";
import { createQueryClient, useAsked } from "./queries";

beforeEach(() => {
  vi.useFakeTimers();
});
afterEach(() => {
  cleanup();
  onlineManager.setOnline(true);
  focusManager.setFocused(undefined);
  vi.useRealTimers();
});

interface Props {
  name: string;
  ask: () => Promise<string>;
  again?: number;
  keep?: boolean;
}

function Answer({ name, ask, again, keep = false }: Props) {
  const { data, error } = useAsked({ key: [name], ask, keep, ...(again && { again }) });
  return (
    <p>
      {data ?? "nothing"}
      {error && `, ${error.title}`}
    </p>
  );
}

const text = () => document.querySelector("p")?.textContent;
const pass = (ms: number) => act(() => vi.advanceTimersByTimeAsync(ms));

function shown(props: Props) {
  const client = createQueryClient();
  const tree = (of: Props) => (
    <QueryClientProvider client={client}>
      <Answer {...of} />
    </QueryClientProvider>
  );
  const { rerender } = render(tree(props));
  return (of: Props) => rerender(tree(of));
}

test("a failure is told until there is an answer, also while it is asked again", async () => {
  const ask = vi.fn(async (): Promise<string> => {
    await new Promise((resolve) => setTimeout(resolve, 500));
    if (ask.mock.calls.length < 3) throw noAnswer();
    return "42";
  });
  shown({ name: "a", ask, again: 1000 });
  await pass(510);
  expect(text()).toBe("nothing, The console did not answer.");
  await pass(1200); // asked for the second time, not answered yet
  expect(ask).toHaveBeenCalledTimes(2);
  expect(text()).toBe("nothing, The console did not answer.");
  await pass(2000);
  expect(text()).toBe("42");
});

test("the answer to the question before stays only where that is wanted", async () => {
  const slow = () => new Promise<string>((resolve) => setTimeout(() => resolve("late"), 500));
  for (const keep of [true, false]) {
    const change = shown({ name: "a", ask: async () => "first", keep });
    await pass(10);
    change({ name: "b", ask: slow, keep });
    await pass(10);
    expect(text()).toBe(keep ? "first" : "nothing");
    await pass(600);
    expect(text()).toBe("late");
    cleanup();
  }
});

test("a browser that believes itself offline or comes back asks neither later nor more", async () => {
  onlineManager.setOnline(false);
  const ask = vi.fn(async () => "42");
  shown({ name: "a", ask });
  await pass(10);
  expect(text()).toBe("42");
  act(() => onlineManager.setOnline(true));
  act(() => focusManager.setFocused(false));
  act(() => focusManager.setFocused(true));
  await pass(10);
  expect(ask).toHaveBeenCalledTimes(1);
});

test("what is asked again and again is, whoever looks at another window", async () => {
  focusManager.setFocused(false);
  const ask = vi.fn(async () => "42");
  shown({ name: "a", ask, again: 1000 });
  await pass(3500);
  expect(ask).toHaveBeenCalledTimes(4);
});

test("what is sent is sent at once, also from a browser that believes itself offline", async () => {
  onlineManager.setOnline(false);
  const send = vi.fn(async () => "sent");
  function Sender() {
    const { mutate, data } = useMutation({ mutationFn: send });
    return (
      <button type="button" onClick={() => mutate()}>
        {data ?? "send"}
      </button>
    );
  }
  render(
    <QueryClientProvider client={createQueryClient()}>
      <Sender />
    </QueryClientProvider>,
  );
  fireEvent.click(screen.getByRole("button"));
  await pass(10);
  expect(screen.getByRole("button").textContent).toBe("sent");
});
