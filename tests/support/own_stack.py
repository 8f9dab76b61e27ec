"""Stacks of other recipes than the first, and their pages, for a module of tests."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import httpx

from tests.support.robot import Robot
from tests.support.stack import TOKEN, Stack


def started(stack: Stack) -> Iterator[Robot]:
    """A client on a stack's domain; the stack ends with it, and in good order."""
    try:
        client = Robot(stack.domain)
        try:
            yield client
        finally:
            client.close()
    finally:
        assert stack.close() == 0, stack.output


@contextmanager
def logged_in(stack: Stack) -> Iterator[httpx.Client]:
    """The console, as the page asks it."""
    with httpx.Client(base_url=stack.url, headers={"Origin": stack.url}, timeout=30) as client:
        assert client.post("/api/login", json={"token": TOKEN}).status_code == 200
        yield client


def add_rule(page: httpx.Client, rule: dict[str, Any]) -> None:
    """As an operator does it on the page; it stays."""
    view = page.get("/api/rules").json()
    table = {**view["table"], "rules": [*view["table"]["rules"], rule]}
    wanted = {"table": table, "expected_revision": view["revision"], "probation": 0.0}
    answer = page.post("/api/rules/apply", json=wanted)
    assert answer.status_code == 200, answer.text
