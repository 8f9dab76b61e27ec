"""Whoever does what the documentation says gets what it promises."""

from __future__ import annotations

import inspect
import json
import re
import shlex
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import typer.main
import yaml

from kompass.bench.barn_file import read_barn
from kompass.components import Controller, DriveManager, LocalMapper, MapServer, Planner
from kompass.components.base.config_file import read_config_file
from kompass.drills.scenario_file import BadScenario, parse_scenario, scenario_text
from kompass.launch.launcher import Launcher
from kompass.monitor.introspection.catalog import RecipeCatalog
from kompass.monitor.tables.recipe_check import faults_of
from kompass.recipe.table import RecipeRules, recipe_rules
from kompass.rulebook.guard import guard
from kompass.rulebook.permissions import Permissions
from kompass.rulebook.sources import with_sources
from kompass.rules.schema.table import Table, rule_hash
from kompass_console.cli import app, name_the_world
from kompass_console.cli_error import CliError
from kompass_console.drill_cli import recipe_first
from kompass_console.rules_cli.table_file import TableFile
from kompass_console.webhooks.notice import Notice
from kompass_console.webhooks.sender import notice_body
from kompass_console.webhooks.settings import read_webhooks
from tests.docs.blocks import PAGES, ROOT, Block, all_blocks, blocks_of, links_of, paths_of
from tests.docs.preludes import PRELUDES, Bringup

LANGUAGES = {
    "sh", "python", "yaml", "json", "ini", "nginx", "caddyfile", "text",
}  # fmt: skip
# Programs that the documentation tells people to run and that no test can run, and why not.
NOT_RUN = {
    "sudo": "changes the machine",
    "systemctl": "acts on the services of the machine",
    "journalctl": "reads the log of a service that is not there",
    "loginctl": "acts on the users of the machine",
    "ros2": "comes with a ROS installation, which tests do not have",
    "source": "reads the set-up of a ROS installation, which tests do not have",
    "git": "changes the checkout",
    "scp": "reads the key of a robot that is not there",
    "chmod": "changes a file that is not there",
    "tar": "reads the data of a robot that is not there",
    "sqlite3": "reads the data of a robot that is not there",
    "npm": "is run by scripts/setup and scripts/check themselves",
    "pip": "is run by scripts/setup itself",
    "kill": "ends a process that is not there",
    "mcap": "is a program of others",
}
# Blocks of Python that cannot be run, and why not.
NOT_RUN_BLOCKS = {"needs-files": "it reads files that the reader brings"}


def ids(block: Block) -> str:
    return block.where


@pytest.mark.parametrize("block", all_blocks(), ids=ids)
def test_every_block_says_what_language_it_is(block: Block) -> None:
    known = LANGUAGES | ({""} if block.page.name == "design.md" else set())
    assert block.language in known, f"{block.where}: {block.language!r}"


# -- commands ---------------------------------------------------------------------------------


def commands_of(block: Block) -> Iterator[list[str]]:
    for line in re.sub(r"\\\n\s*", " ", block.text).splitlines():
        # A dot in the middle of a line separates commands that are only listed.
        for part in line.split(" · "):
            words = shlex.split(part, comments=True)
            if words:
                yield words


@pytest.mark.parametrize("block", all_blocks("sh"), ids=ids)
def test_every_command_is_one_that_can_be_given(block: Block) -> None:
    done = subprocess.run(["bash", "-n"], input=block.text, text=True, capture_output=True)
    assert not done.returncode, f"{block.where}: {done.stderr}"
    for words in commands_of(block):
        while words and re.match(r"[A-Z_]+=", words[0]):
            words = words[1:]
        program = words[0]
        if program.removeprefix(".venv/bin/") == "kompass-console":
            parse(cut_at_pipe(words[1:]), block)
        elif program.startswith("scripts/"):
            script = ROOT / program
            assert script.is_file(), f"{block.where}: there is no {program}"
            subprocess.run(["bash", "-n", str(script)], check=True)
        elif program.endswith("python"):
            check_python(words[1:], block)
        elif program in (".", "cd"):
            continue
        else:
            assert program in NOT_RUN, f"{block.where}: '{program}' is neither run nor listed"


def cut_at_pipe(words: list[str]) -> list[str]:
    for index, word in enumerate(words):
        if word in ("|", ">", ">>", "&", "&&", ";"):
            return words[:index]
    return words


def parse(arguments: list[str], block: Block) -> None:
    """Read a command of ours as the command line does, and run nothing."""
    arguments = name_the_world(recipe_first(arguments))
    command: Any = typer.main.get_command(app)
    while hasattr(command, "commands"):
        if not arguments or arguments[0] in ("--help", "-h"):
            return
        if command.invoke_without_command and arguments[0] not in command.commands:
            break  # a command itself, with options of its own
        assert arguments[0] in command.commands, f"{block.where}: there is no {arguments[0]!r}"
        command, arguments = command.commands[arguments[0]], arguments[1:]
    if "--help" in arguments or arguments in (["…"], ["..."]):
        return
    known = {name for one in command.params for name in one.opts}
    for word in arguments:
        if word.startswith("-"):
            assert word.partition("=")[0] in known, f"{block.where}: there is no option {word}"
    try:
        command.make_context("kompass-console", list(arguments))
    except Exception as error:  # noqa: BLE001 - whatever the reader would be told
        pytest.fail(f"{block.where}: {' '.join(arguments)}: {error}")


def check_python(words: list[str], block: Block) -> None:
    if words[:1] == ["-m"]:
        module = ROOT / Path(*words[1].split("."))
        assert (
            module.with_suffix(".py").is_file()
            or module.is_dir()
            or words[1] in ("pytest", "mkdocs", "venv")
        ), f"{block.where}: there is no module {words[1]}"


def test_the_commands_that_need_no_robot_do_what_they_say(
    capsys: pytest.CaptureFixture[str],
) -> None:
    with pytest.raises(SystemExit) as ended:
        app(["rules", "schema"], standalone_mode=True)
    assert not ended.value.code
    schema = json.loads(capsys.readouterr().out)
    assert {"Rule", "Event"} <= set(schema["$defs"])


# -- rules ------------------------------------------------------------------------------------


def robot() -> list[Any]:
    """The components of recipe 01, and its map server."""
    return [
        Planner("planner"),
        Controller("controller"),
        LocalMapper("mapper"),
        DriveManager("drive_manager"),
        MapServer("map_server"),
    ]


def is_rules(block: Block) -> bool:
    others = ("settings", "scenario", "worlds", "webhooks")
    return not any(block.option(other) for other in others) and "refused" not in block.note.split()


def table_of(block: Block, folder: Path) -> Table:
    file = folder / f"rules.{block.language}"
    data = yaml.safe_load(block.text)
    if isinstance(data, dict) and "rules" not in data:  # one rule by itself
        data = [data]
        file = folder / "rules.json"
        file.write_text(json.dumps(data), encoding="utf-8")
    else:
        file.write_text(block.text, encoding="utf-8")
    return TableFile(file).table


RULE_BLOCKS = [block for block in all_blocks("yaml", "json") if is_rules(block)]


@pytest.mark.parametrize("block", RULE_BLOCKS, ids=ids)
def test_every_rule_is_accepted_by_a_robot(block: Block, tmp_path: Path) -> None:
    table = table_of(block, tmp_path)
    components = robot()
    empty = recipe_rules({}, components)
    catalog = RecipeCatalog(components, empty)
    found = [finding for rule in table.rules for finding in faults_of(rule, catalog)]
    permissions = Permissions(catalog.components(), Table())
    role = "engineer" if "engineer" in block.note.split() else "operator"
    table = with_sources(table, Table(), role)
    found += guard(Table(), table, role=role, recipe_table=Table(), permissions=permissions)
    assert not [f"{one.rule_id} {one.field}: {one.text}" for one in found]


@pytest.mark.parametrize(
    "block", [b for b in all_blocks("yaml", "json") if "refused" in b.note.split()], ids=ids
)
def test_what_is_said_to_be_refused_is_refused(block: Block, tmp_path: Path) -> None:
    with pytest.raises(CliError) as refused:
        table_of(block, tmp_path)
    assert "cool_down" in str(refused.value)


@pytest.mark.parametrize(
    "block", [b for b in all_blocks("yaml", "json") if b.option("settings")], ids=ids
)
def test_every_file_of_settings_is_taken(block: Block, tmp_path: Path) -> None:
    file = tmp_path / f"settings.{block.language}"
    file.write_text(block.text, encoding="utf-8")
    sections = set(read_config_file(str(file))) - {"/**"}
    assert sections <= {component.node_name for component in robot()}
    for component in robot():
        component.apply_config_file(str(file))


def webhook_block(option: str) -> Block:
    [block] = [b for b in all_blocks("yaml", "json") if b.option("webhooks") == option]
    return block


def test_the_file_of_webhooks_is_taken(tmp_path: Path) -> None:
    file = tmp_path / "webhooks.yaml"
    file.write_text(webhook_block("yes").text, encoding="utf-8")
    file.chmod(0o600)
    assert len(read_webhooks(file)) == 2


def test_a_notice_has_the_fields_that_are_shown() -> None:
    shown = json.loads(webhook_block("body").text)
    sent = json.loads(notice_body("ava", Notice("stop", "Stopped by ben: a child")))
    assert {name: type(value) for name, value in sent.items()} == {
        name: type(value) for name, value in shown.items()
    }


def scenario_blocks(option: str) -> list[Block]:
    return [b for b in all_blocks("yaml") if b.option("scenario") == option]


@pytest.mark.parametrize("block", scenario_blocks("yes"), ids=ids)
def test_every_scenario_is_read_and_written_back(block: Block) -> None:
    scenario = parse_scenario(block.text, block.where)
    assert parse_scenario(scenario_text(scenario)) == scenario


@pytest.mark.parametrize(
    "block", [block for block in all_blocks("json") if block.option("worlds")], ids=ids
)
def test_every_file_of_worlds_is_read(block: Block, tmp_path: Path) -> None:
    file = tmp_path / "worlds.json"
    file.write_text(block.text, encoding="utf-8")
    read = read_barn(file)
    assert read.worlds[0].place(read.start, read.goal).obstacles


@pytest.mark.parametrize("block", scenario_blocks("refused"), ids=ids)
def test_a_scenario_is_refused_with_what_the_page_says(block: Block) -> None:
    with pytest.raises(BadScenario) as refused:
        parse_scenario(block.text, "crate.yaml")
    told = str(refused.value)
    text = next(b.text for b in blocks_of(block.page) if b.line > block.line)
    assert told.startswith(text.strip().removesuffix("…").rstrip(" ,"))


# -- Python -----------------------------------------------------------------------------------


def python_blocks() -> list[Block]:
    return [b for b in all_blocks("python") if b.option("not-run") is None]


@pytest.mark.parametrize("block", all_blocks("python"), ids=ids)
def test_python_that_is_not_run_says_why(block: Block) -> None:
    reason = block.option("not-run")
    assert reason is None or reason in NOT_RUN_BLOCKS, f"{block.where}: {reason!r} is not listed"


@pytest.mark.parametrize("block", python_blocks(), ids=ids)
def test_every_python_block_runs(
    block: Block, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Recipes are read as far as their bring-up; nothing is started."""
    scope = run(block, tmp_path, monkeypatch)
    rules = rules_of(scope)
    if "same-as-above" in block.note.split():
        before = [b for b in blocks_of(block.page) if b.line < block.line and b.language == "yaml"]
        told = table_of(before[-1], tmp_path)
        assert [(rule.id, rule_hash(rule)) for rule in rules.table.rules] == [
            (rule.id, rule_hash(rule)) for rule in told.rules
        ]


def run(block: Block, folder: Path, monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    monkeypatch.chdir(folder)
    scope: dict[str, Any] = {"__name__": "__main__", "__file__": str(folder / "recipe.py")}
    prelude = block.option("prelude")
    launchers: list[Launcher] = []

    def bringup(self: Launcher, *_: Any, **__: Any) -> None:
        launchers.append(self)
        raise Bringup

    monkeypatch.setattr(Launcher, "bringup", bringup)
    if prelude is not None:
        exec(compile(PRELUDES[prelude], f"prelude {prelude}", "exec"), scope)
    # Line numbers are those of the page, so that what fails is found.
    source = "\n" * block.line + block.text
    try:
        exec(compile(source, str(block.page), "exec"), scope)
    except Bringup:
        scope["launcher"] = launchers[0]
    tests = [thing for name, thing in scope.items() if name.startswith("test_")]
    for test in tests:
        needs = inspect.signature(test).parameters
        assert not needs, f"{block.where}: {test.__name__} needs {', '.join(needs)}"
        test()
    return scope


def rules_of(scope: dict[str, Any]) -> RecipeRules:
    """The rules that a block makes, checked as at its bring-up."""
    launcher = scope.get("launcher")
    components = list(launcher.components) if isinstance(launcher, Launcher) else []
    events_actions = scope.get("events_actions")
    if events_actions is None:
        events_actions = getattr(launcher, "_events_actions", {})
    made = recipe_rules(events_actions, components)
    catalog = RecipeCatalog(components, made)
    found = [finding for rule in made.table.rules for finding in faults_of(rule, catalog)]
    assert not [f"{one.rule_id} {one.field}: {one.text}" for one in found]
    return made


# -- files of other programs ------------------------------------------------------------------


@pytest.mark.parametrize("block", all_blocks("ini"), ids=ids)
def test_every_systemd_unit_is_one(block: Block, tmp_path: Path) -> None:
    """Every section and setting is known to systemd, where it is installed."""
    text = block.text
    assert "[Service]" in text
    verify = shutil.which("systemd-analyze")
    if verify is None:
        return
    # The program is wherever the reader has put it.
    text = re.sub(r"^ExecStart=\S+", "ExecStart=/bin/true", text, flags=re.MULTILINE)
    unit = tmp_path / "kompass.service"
    unit.write_text(re.sub(r"^User=.*$", "User=root", text, flags=re.MULTILINE), encoding="utf-8")
    done = subprocess.run([verify, "verify", str(unit)], text=True, capture_output=True)
    assert "kompass.service" not in done.stderr, done.stderr


@pytest.mark.parametrize("block", all_blocks("nginx"), ids=ids)
def test_every_nginx_configuration_is_one(block: Block, tmp_path: Path) -> None:
    nginx = shutil.which("nginx")
    if nginx is None:
        assert "proxy_set_header Upgrade" in block.text
        return
    certificate(tmp_path)
    text = re.sub(r"/etc/ssl/\S+/(\w+\.pem)", rf"{tmp_path}/\1", block.text)
    whole = tmp_path / "nginx.conf"
    whole.write_text(
        f"pid {tmp_path}/pid;\nerror_log {tmp_path}/error.log;\nevents {{}}\n"
        f"http {{\naccess_log off;\n{text}\n}}\n",
        encoding="utf-8",
    )
    done = subprocess.run(
        [nginx, "-t", "-c", str(whole), "-p", str(tmp_path)], text=True, capture_output=True
    )
    assert not done.returncode, done.stderr


@pytest.mark.parametrize("block", all_blocks("caddyfile"), ids=ids)
def test_every_caddyfile_is_one(block: Block, tmp_path: Path) -> None:
    caddy = shutil.which("caddy")
    if caddy is None:
        assert "reverse_proxy" in block.text
        return
    file = tmp_path / "Caddyfile"
    file.write_text(block.text, encoding="utf-8")
    done = subprocess.run(
        [caddy, "adapt", "--config", str(file), "--adapter", "caddyfile", "--validate"],
        text=True,
        capture_output=True,
        env={"HOME": str(tmp_path), "PATH": "/usr/bin:/bin"},
    )
    assert not done.returncode, done.stderr


def certificate(folder: Path) -> None:
    """A certificate for a name that is in no DNS."""
    subject = ["-subj", "/CN=robot.example", "-days", "1", "-nodes"]
    files = ["-keyout", str(folder / "key.pem"), "-out", str(folder / "certificate.pem")]
    command = ["openssl", "req", "-x509", "-newkey", "rsa:2048", *subject, *files]
    subprocess.run(command, check=True, capture_output=True)


# -- links and names --------------------------------------------------------------------------


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_every_link_leads_to_a_page(page: Path) -> None:
    from docs.hooks.pages import page_names

    for link in links_of(page):
        target = link.partition("#")[0]
        file = (page.parent / target).resolve()
        if page.parent.name == "docs" and target in page_names():
            continue
        assert file.exists(), f"{page.name}: {link} leads nowhere"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_every_file_that_is_named_exists(page: Path) -> None:
    missing = [
        path for path in paths_of(page) if not any(ROOT.glob(path.rstrip("/"))) and "…" not in path
    ]
    assert not missing, f"{page.name} names {', '.join(missing)}"


def test_every_variable_of_the_environment_is_told() -> None:
    from docs.hooks.environment import FOR_TESTS, VARIABLES

    told = {name for name, *_ in VARIABLES} | {name for name, _ in FOR_TESTS}
    inner = {"KOMPASS_WORKER_PARENT", "KOMPASS_TEST_RUN"}  # between our own processes
    read = set()
    for folder in ("kompass", "kompass_console", "scripts", "tests"):
        for file in (ROOT / folder).rglob("*"):
            if file.is_file() and (file.suffix == ".py" or folder == "scripts"):
                read |= set(re.findall(r"\bKOMPASS_[A-Z_]+\b", file.read_text(encoding="utf-8")))
    assert not read - told - inner, "tell of them in docs/hooks/environment.py"
    ours = {name for name in told if name.startswith("KOMPASS_")}
    assert not ours - read, "nobody reads them"


def test_the_websockets_of_the_console_are_told() -> None:
    from docs.hooks.http_api import http_page

    page = http_page(ROOT / "web" / "openapi.json")
    for file in (ROOT / "kompass_console" / "api").glob("*.py"):
        for path in re.findall(r'websocket\("(/api/[^"]+)"', file.read_text(encoding="utf-8")):
            assert f"`{path}`" in page, path
    assert page.count(" /api/") > 20
