"""Who logs in by name: what it takes, how long it lasts, and what ends it."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from pathlib import Path

import httpx
import pytest
from typer.testing import CliRunner

from kompass_console.accounts.accounts import Accounts
from kompass_console.accounts.passwords import hashed
from kompass_console.cli_error import CliError
from kompass_console.schema.roles import Role
from kompass_console.stack import ConsoleListener
from kompass_console.users_cli import app
from tests.console.conftest import TOKENS, Served, serving
from tests.console.rules_client import closed_with, opened
from tests.support.patience import patient

pytestmark = pytest.mark.ros

PASSWORD = "four words of ava's"
HASH = hashed(PASSWORD)


@pytest.fixture
def accounts(tmp_path: Path) -> Accounts:
    made = Accounts(tmp_path / "accounts.json")
    made.add("Ava", Role.OPERATOR, HASH)
    return made


@pytest.fixture
def served(tmp_path: Path, domain: int, accounts: Accounts) -> Iterator[Served]:
    with serving(tmp_path / "audit", domain, accounts_file=tmp_path / "accounts.json") as served:
        yield served


def log_in(client: httpx.Client, name: str = "ava", password: str = PASSWORD) -> httpx.Response:
    return client.post("/api/login", json={"user": name, "password": password})


def is_in(client: httpx.Client) -> bool:
    return client.get("/api/session").status_code == 200


def test_a_name_and_its_password_open_the_console_in_the_role_of_the_account(
    served: Served,
) -> None:
    with served.client() as client:
        assert client.get("/api/login").json() == {"accounts": True, "tokens": True}
        answer = log_in(client, " AVA ")
        told = {"user": "Ava", "role": "operator", "account": True}
        assert answer.json() == {**told, "key": answer.json()["key"]}
        assert client.get("/api/session").json() == answer.json()
        assert client.get("/api/audit").status_code == 403  # for engineers
    lines = [(line["who"], line["role"], line["outcome"]) for line in served.audited()]
    assert ("Ava", "operator", "ok") in lines


@pytest.mark.parametrize("name", ["ava", "nobody at all"])
def test_a_wrong_password_and_a_wrong_name_are_told_alike(served: Served, name: str) -> None:
    with served.client() as client:
        answer = log_in(client, name, "guessed at random")
        assert answer.status_code == 403
        assert answer.json()["detail"]["title"] == "This name and this password do not fit."
        assert "set-cookie" not in answer.headers
        assert not is_in(client)
    assert "guessed at random" not in json.dumps(served.audited())


@pytest.mark.parametrize(
    "body",
    [
        {},
        {"user": "ava"},
        {"password": PASSWORD},
        {"user": "ava", "password": PASSWORD, "token": TOKENS[Role.VIEWER]},
        {"user": "a" * 500, "password": PASSWORD},
    ],
)
def test_half_a_log_in_is_none(served: Served, body: dict[str, str]) -> None:
    with served.client() as client:
        assert client.post("/api/login", json=body).status_code == 422
        assert not is_in(client)


def test_who_guesses_passwords_waits(served: Served) -> None:
    with served.client() as client:
        codes = [log_in(client, password=f"guess no. {i}").status_code for i in range(11)]
    assert codes == [403] * 10 + [429]


def test_who_guesses_many_passwords_at_once_waits_too(served: Served) -> None:
    with ExitStack() as kept, ThreadPoolExecutor(30) as pool:
        clients = [kept.enter_context(served.client()) for _ in range(30)]
        codes = list(pool.map(lambda client: log_in(client, password="?").status_code, clients))
    assert sorted(codes) == [403] * 10 + [429] * 20


def test_a_session_by_name_outlives_the_console_and_its_tokens(
    tmp_path: Path, domain: int, accounts: Accounts
) -> None:
    file = tmp_path / "accounts.json"
    with serving(tmp_path / "audit", domain, accounts_file=file) as first, ExitStack() as kept:
        client = kept.enter_context(first.client())
        log_in(client)
        cookie = next(iter(client.cookies.values()))
    other = {role: f"another-{token}" for role, token in TOKENS.items()}
    again = serving(tmp_path / "audit", domain, accounts_file=file, access_tokens=other)
    with again as second, second.client() as client:
        client.cookies.set(f"kompass_session_{second.port}", cookie)
        assert client.get("/api/session").json()["user"] == "Ava"


@pytest.mark.parametrize("change", ["remove", "passwd", "role", "logout"])
def test_what_is_changed_of_an_account_ends_its_sessions_and_their_sockets_at_once(
    served: Served, accounts: Accounts, tmp_path: Path, change: str
) -> None:
    given = {"role": ["engineer"], "passwd": ["--stdin"]}.get(change, [])
    command = [change, "ava", *given, "--data-dir", str(tmp_path)]
    with served.client() as client, served.client(Role.OPERATOR, user="ben") as other:
        log_in(client)
        with opened(served, "/api/state", client) as socket:
            done = CliRunner().invoke(app, command, input="another one of hers\n")
            assert done.exit_code == 0, done.output
            assert "all sessions" in done.output.casefold()
            assert not is_in(client)
            assert is_in(other)
            assert closed_with(socket) == 4401
        gone = {"remove": 403, "passwd": 403, "role": 200, "logout": 200}
        assert log_in(client).status_code == gone[change]


def test_one_logs_out_elsewhere_and_stays_where_one_is(served: Served) -> None:
    with served.client() as here, served.client() as there:
        log_in(here)
        log_in(there)
        with opened(served, "/api/state", here) as mine, opened(served, "/api/state", there) as far:
            assert here.post("/api/logout/others").status_code == 204
            assert is_in(here)
            assert not is_in(there)
            assert closed_with(far) == 4401
            mine.send('{"type": "ping", "t": 4242.5}')
            while "4242.5" not in str(mine.recv(timeout=patient(5.0))):
                pass  # the robot's state is told, too
    with served.client(Role.OPERATOR) as by_token:
        refused = by_token.post("/api/logout/others")
        assert refused.status_code == 409
        assert "token" in refused.json()["detail"]["title"]
        assert is_in(by_token)


def test_who_has_a_token_does_not_pass_for_who_has_an_account(served: Served) -> None:
    with served.client() as client:
        body = {"token": TOKENS[Role.OPERATOR], "user": "aVA"}
        assert client.post("/api/login", json=body).json()["user"] == "aVA (token)"


def test_where_people_log_in_by_name_no_token_is_made(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("KOMPASS_DATA_DIR", str(tmp_path))
    Accounts(tmp_path / "accounts.json").add("ava", Role.ENGINEER, HASH)
    listener = ConsoleListener("0.0.0.0", 0, False, "robot", None, "here")
    with listener.socket:
        listener.announce()
    assert "by name and password" in (said := capsys.readouterr().out)
    assert "token=" not in said


def test_a_console_for_others_that_nobody_may_enter_is_refused_with_the_remedy(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("KOMPASS_DATA_DIR", str(tmp_path))
    with pytest.raises(CliError, match=r"users add NAME --role engineer.*--token"):
        ConsoleListener("0.0.0.0", 0, False, "robot", None, "here")
    with ConsoleListener("127.0.0.1", 0, False, "robot", None, "here").socket:
        pass


def test_accounts_are_managed_from_a_terminal(tmp_path: Path) -> None:
    console_command = str(Path(sys.executable).with_name("kompass-console"))

    def users(*arguments: str, given: str = "") -> tuple[int, str]:
        done = subprocess.run(
            [console_command, "users", *arguments, "--data-dir", str(tmp_path)],
            input=given,
            capture_output=True,
            text=True,
            check=False,
            timeout=patient(20),
        )
        return done.returncode, done.stdout + done.stderr

    assert users("add", "ava", "--role", "operator")[0] == 2  # nobody to ask for a password
    code, said = users("add", "ava", "--role", "operator", "--stdin", given="short\n")
    assert (code, "5 characters" in said) == (2, True)
    assert users("list")[1].startswith("There are no accounts")
    code, said = users("add", "ava", "--role", "operator", "--stdin", given=PASSWORD + "\n")
    assert (code, "prints no tokens any more" in said) == (0, True), said
    assert PASSWORD not in (tmp_path / "accounts.json").read_text()
    code, said = users("passwd", "ben", "--stdin", given=PASSWORD + "\n")
    assert (code, "no account 'ben'; there are: ava" in said) == (1, True)
    assert "operator" in users("list")[1]
    assert "That was the last account" in users("remove", "AVA")[1]
