"""``kompass-console rules …`` on a running stack, as a person and as a script use it."""

import json
import os
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager, nullcontext
from pathlib import Path
from typing import Any, NamedTuple

import pytest
import yaml
from std_msgs.msg import Bool, Float32

from kompass.backtest.report import BacktestReport
from kompass.rulebook.schema.report import ApplyReport, CheckReport, Conflict
from kompass.rulebook.schema.revision import History
from kompass.rules.schema.table import Table
from kompass_console.cli import app
from kompass_console.cli_error import CliError
from kompass_console.rules_cli.connection import MonitorConnection
from kompass_console.rules_cli.options import RobotOptions
from kompass_console.rules_cli.table_file import TableFile
from tests.support.processes import wait_until
from tests.support.robot import Robot
from tests.support.stack import Stack

RECIPE = """
from kompass.actions import LogInfo
from kompass.components import Component
from kompass.ros import Event, Launcher, Topic

lamp = Component(component_name="lamp")
dark = Event(Topic(name="/dark", msg_type="Bool").msg.data == True, on_change=True)
dark.name = "dark"
launcher = Launcher()
launcher.kompass(components=[lamp], events_actions={dark: LogInfo(msg="it is dark")})
launcher.bringup()
"""
MORE = """
- id: more
  event:
    condition:
      kind: compare
      signal: {topic: more, type: std_msgs/msg/Bool, path: [data]}
      operator: "=="
      value: true
  actions:
  - kind: log
    text: more
"""


class Ran(NamedTuple):
    """How a command ended, and what it printed."""

    code: int
    out: str
    error: str


NEAR = """
- id: too-near
  name: Too near
  event:
    condition:
      kind: compare
      signal: {topic: nearest, type: std_msgs/msg/Float32, path: [data], timeout: 1.0}
      operator: "<"
      value: 0.5
    trigger: edge
    hold: 2.0
  actions:
    - {kind: publish, topic: halt, type: std_msgs/msg/Bool, message: {data: true}}
"""
Run = Callable[..., Ran]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("rules")
    (made / "lamp.py").write_text(RECIPE)
    return made


@pytest.fixture(scope="module")
def stack(folder: Path) -> Iterator[Stack]:
    options = ("--name", "desk lamp", "--data-dir", str(folder / "data"))
    with closing(Stack.active(folder / "lamp.py", *options)) as running:
        yield running


@pytest.fixture(scope="module")
def connection(stack: Stack) -> Iterator[MonitorConnection]:
    """One for all tests: to find a robot takes longer than to ask it."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_DOMAIN_ID", str(stack.domain))
        client = MonitorConnection(None, timeout=30.0)
    with client:
        yield client


@pytest.fixture
def run(connection: MonitorConnection, capsys: pytest.CaptureFixture[str]) -> Run:
    """Run a command in this process, as the entry point does."""

    def command(*arguments: str) -> Ran:
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(RobotOptions, "connect", lambda robot: nullcontext(connection))
            return in_this_process(capsys, *arguments)

    return command


def in_this_process(capsys: pytest.CaptureFixture[str], *arguments: str) -> Ran:
    code = 0
    try:
        app(["rules", *arguments], standalone_mode=False)
    except CliError as problem:
        code = problem.code
        print(problem, file=sys.stderr)  # noqa: T201 - as the entry point does
    return Ran(code, *capsys.readouterr())


@pytest.fixture
def edited(run: Run, tmp_path: Path) -> Path:
    """The rules in force as a file, with one more."""
    file = tmp_path / "rules.yaml"
    assert run("export", "-o", str(file)).code == 0
    text = file.read_text().partition("- id: more")[0]
    file.write_text(text.rstrip() + MORE.replace("more\n", f"{tmp_path.name}\n", 1))
    return file


def revision_of(run: Run) -> int:
    return int(json.loads(run("show", "--json").out)["active"])


@pytest.mark.ros
def test_an_edit_goes_all_the_way(run: Run, stack: Stack, edited: Path, folder: Path) -> None:
    before = revision_of(run)
    checked = run("check", str(edited))
    assert checked.code == 0
    assert "+ " + edited.parent.name in checked.out
    assert revision_of(run) == before

    applied = run("apply", str(edited), "--yes", "--author", "ava", "-m", "it is late")
    assert applied.code == 0, applied
    assert f"revision {before + 1} is in force" in applied.out
    assert f"keep it:      kompass-console rules confirm {before + 1}" in applied.out
    assert "on probation" in run("show").out
    assert run("confirm").code == 0
    shown = run("show").out
    assert "desk lamp revision" in shown
    assert "✓ confirmed" in shown

    told = run("history").out
    assert "ava (engineer)" in told
    assert "it is late" in told
    assert "◀ in force" in told
    assert edited.parent.name in run("diff", str(before)).out

    robot = Robot(stack.domain)
    try:
        publisher = robot.node.create_publisher(Bool, "/dark", 10)
        wait_until(lambda: publisher.get_subscription_count() > 0, 10, "the monitor listens")

        def fired() -> bool:
            publisher.publish(Bool(data=False))
            publisher.publish(Bool(data=True))
            return "done" in run("firings", "--rule", "dark").out

        wait_until(fired, 20, "the rule fires")
    finally:
        robot.close()
    why = run("explain", "dark").out
    assert "dark.data" in why
    assert "now true" in why.lower()
    run_id = json.loads(run("firings", "--json").out)["firings"][-1]["run_id"]
    then = run("explain", "dark", "--run", str(run_id)).out
    assert "it is dark" in then

    back = run("rollback", str(before), "--yes")
    assert back.code == 0, back
    assert f"− {edited.parent.name}" in back.out
    assert f"revision {before + 2} is in force" in back.out
    assert (folder / "data").is_dir()


@pytest.fixture
def here(stack: Stack, folder: Path, capsys: pytest.CaptureFixture[str]) -> Run:
    """Run a command as the robot's owner on the robot's machine; ROS is not asked."""

    def connect(_: RobotOptions) -> None:
        raise AssertionError("ROS was asked")

    def command(*arguments: str, key: str | None = None) -> Ran:
        with pytest.MonkeyPatch.context() as patch:
            patch.setenv("ROS_DOMAIN_ID", str(stack.domain))
            patch.setenv("KOMPASS_DATA_DIR", str(folder / "data"))
            patch.delenv("KOMPASS_ROBOT_KEY", raising=False)
            if key is not None:
                patch.setenv("KOMPASS_ROBOT_KEY", key)
            patch.setattr(RobotOptions, "connect", connect)
            return in_this_process(capsys, *arguments)

    return command


@pytest.mark.ros
@pytest.mark.parametrize(
    "command",
    [
        ("show", "--json"),
        ("history", "--json"),
        ("diff", "1"),
        ("firings", "--json"),
        ("export",),
        ("export", "--revision", "1"),
        ("diff", "1", "77"),
        ("show", "--revision", "77"),
        ("explain", "bright"),
    ],
    ids=" ".join,
)
def test_on_its_own_machine_a_robot_answers_without_ros_as_it_does_over_ros(
    run: Run, here: Run, command: tuple[str, ...]
) -> None:
    while True:
        # What is told of the moment (who publishes, say) may change between two questions.
        before, told, after = run(*command), here(*command), run(*command)
        if before == after:
            break
    assert told == before


@pytest.mark.ros
def test_states_and_reasons_are_told_without_ros_too(here: Run) -> None:
    shown = here("show").out
    assert "desk lamp revision" in shown
    assert any(state in shown for state in ("● ", "◌ ", "○ "))
    assert "dark.data" in here("explain", "dark").out


@pytest.mark.ros
def test_who_names_a_key_or_another_robot_is_answered_over_ros(here: Run) -> None:
    with pytest.raises(AssertionError, match="ROS was asked"):
        here("show", "--namespace", "elsewhere")
    with pytest.raises(AssertionError, match="ROS was asked"):
        here("show", key=os.environ["KOMPASS_ROBOT_KEY"])


@pytest.mark.ros
def test_brackets_and_colons_of_people_are_printed_as_they_wrote_them(run: Run) -> None:
    reason = "as [bold]Ava[/] said :warning: [/nowhere]"
    off = ("--yes", "--probation", "off")
    assert run("disable", "dark", "-m", reason, "--author", "[red]Bo", *off).code == 0
    told = run("history").out
    assert reason in told
    assert "[red]Bo (engineer)" in told
    assert run("enable", "dark", *off).code == 0


@pytest.mark.ros
def test_a_rule_is_switched_off_and_changed_without_a_file(run: Run) -> None:
    off = ("--yes", "--probation", "off")
    assert run("disable", "dark", "-m", "too noisy", *off).code == 0
    assert "switched off" in run("show").out
    assert run("enable", "dark", *off).code == 0
    assert run("set", "dark", "event.cooldown=20", "actions[0].text=it is night", *off).code == 0
    (dark,) = (
        r for r in json.loads(run("show", "--json").out)["table"]["rules"] if r["id"] == "dark"
    )
    assert dark["event"]["cooldown"] == 20.0
    assert dark["actions"][0]["text"] == "it is night"
    assert dark["source"] == "engineer"
    before = revision_of(run)
    for fields, words in (
        (["event.cooldwn=20"], "event.cooldwn"),
        (["event.cooldown=soon"], "event.cooldown"),
        (["actions[7].text=x"], "has no field actions[7].text"),
        (["nothing"], "is no FIELD=VALUE"),
    ):
        refused = run("set", "dark", *fields, *off)
        assert refused.code == 2
        assert words in refused.error
    assert "there are: dark" in run("disable", "bright", *off).error
    assert revision_of(run) == before


@pytest.mark.ros
def test_an_editor_opens_the_rules_and_nothing_typed_is_lost(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    editor = tmp_path / "editor"
    editor.write_text('#!/bin/sh\nsed -i "$CHANGE" "$1"\n')
    editor.chmod(0o700)
    monkeypatch.setenv("VISUAL", str(editor))
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    before = revision_of(run)

    monkeypatch.setenv("CHANGE", "s/nothing/at all/")
    assert "nothing was changed" in run("edit", "--yes").out
    monkeypatch.setenv("CHANGE", "s/name: dark/name: very dark/")
    changed = run("edit", "--yes", "--probation", "off")
    assert changed.code == 0, changed
    assert revision_of(run) == before + 1
    assert not list(tmp_path.glob("rules-*"))

    monkeypatch.setenv("CHANGE", "s/kind: log/kind: lok/")
    wrong = run("edit", "--yes")
    assert wrong.code == 2
    (kept,) = tmp_path.glob("rules-*.yaml")
    assert str(kept) in wrong.error
    assert "kind: lok" in kept.read_text()
    assert revision_of(run) == before + 1


@pytest.mark.ros
def test_who_was_too_late_sees_both_changes(run: Run, edited: Path) -> None:
    before = revision_of(run)
    assert run("apply", str(edited), "--yes", "--probation", "off").code == 0
    edited.write_text(edited.read_text().replace("text: more", "text: other"))
    late = run("apply", str(edited), "--yes", "--expected-revision", str(before))
    assert late.code == 4
    assert "what they changed" in late.out
    assert "what you changed" in late.out
    late = run("apply", str(edited), "--yes", "--expected-revision", str(before), "--json")
    assert late.code == 4
    assert Conflict.model_validate_json(late.out).expected == before
    assert revision_of(run) == before + 1
    assert run("rollback", "--yes").code == 0


@pytest.mark.ros
def test_scripts_get_the_models_as_json(run: Run, edited: Path) -> None:
    report = CheckReport.model_validate_json(run("check", str(edited), "--json").out)
    assert report.ok
    applied = ApplyReport.model_validate_json(
        run("apply", str(edited), "--yes", "--json", "--probation", "off").out
    )
    history = History.model_validate_json(run("history", "--json").out)
    assert history.active == applied.revision
    assert run("rollback", "--yes", "--json").code == 0


@pytest.mark.ros
def test_what_the_robot_refuses_is_said_with_its_line(run: Run, edited: Path) -> None:
    before = revision_of(run)
    edited.write_text(edited.read_text().replace("path: [data]", "path: [date]"))
    line = (
        edited.read_text()
        .splitlines()
        .index(next(text for text in edited.read_text().splitlines() if "[date]" in text))
        + 1
    )
    for command in (["check", str(edited)], ["apply", str(edited), "--yes"]):
        refused = run(*command)
        assert refused.code == 1
        assert f"{edited}:{line}: rule '{edited.parent.name}'" in refused.out
        assert "did you mean 'data'?" in refused.out
        assert "nothing was changed" in refused.error
    assert revision_of(run) == before


@pytest.mark.ros
def test_nothing_is_applied_that_nobody_agreed_to(
    run: Run, edited: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = revision_of(run)
    unasked = run("apply", str(edited))
    assert (unasked.code, "add --yes" in unasked.error) == (2, True)
    monkeypatch.setattr("sys.stdin.isatty", lambda: True, raising=False)
    monkeypatch.setattr("typer.confirm", lambda question: False)
    assert run("apply", str(edited)).code == 1
    assert run("rollback").code == 1
    assert revision_of(run) == before


@pytest.mark.ros
def test_the_same_table_makes_no_revision(run: Run, tmp_path: Path) -> None:
    before = revision_of(run)
    for form in ("json", "yaml"):
        file = tmp_path / f"same.{form}"
        assert run("export", "--format", form, "-o", str(file)).code == 0
        same = run("apply", str(file), "--yes")
        assert same.code == 0
        assert f"revision {before} is the same" in same.out
    assert run("export", "-o", str(file)).code == 2  # never over a file that is there


@pytest.mark.ros
def test_a_rule_starts_afresh(run: Run) -> None:
    assert run("reset", "dark").code == 0
    unknown = run("reset", "bright")
    assert (unknown.code, "bright" in unknown.error) == (1, True)


@pytest.mark.ros
def test_a_table_is_tried_on_what_was_recorded(run: Run, edited: Path) -> None:
    tried = run("backtest", str(edited), "--json")
    assert tried.code == 0, tried
    report = BacktestReport.model_validate_json(tried.out)
    assert edited.parent.name in [tally.rule_id for tally in report.tallies]
    assert "replayed in" in run("backtest").out


@contextmanager
def saying(stack: Stack, topic: str, value: float) -> Iterator[None]:
    """Ten times a second, on a topic that no rule in force looks at."""
    robot, ending = Robot(stack.domain), threading.Event()
    publisher = robot.node.create_publisher(Float32, topic, 10)

    def say() -> None:
        while not ending.wait(0.1):
            publisher.publish(Float32(data=value))

    thread = threading.Thread(target=say)
    thread.start()
    try:
        yield
    finally:
        ending.set()
        thread.join()
        robot.close()


def with_rule(run: Run, file: Path, rule: str) -> Path:
    """The rules in force as a file, with another one."""
    assert run("export", "-o", str(file)).code == 0
    file.write_text(file.read_text().rstrip() + rule)
    return file


@pytest.mark.ros
def test_what_is_true_now_is_said_first_and_fires_then(
    run: Run, stack: Stack, tmp_path: Path
) -> None:
    """Nobody listened to the nearest obstacle before; it has been near for long."""
    file = with_rule(run, tmp_path / "near.yaml", NEAR)
    said = "'Too near' is true now: it will fire in 2.0 s after Apply (publish on /halt)"
    unknown = run("check", str(file)).out.splitlines()[0]
    assert "not known yet whether 'Too near' is true now: nothing received on nearest" in unknown
    with saying(stack, "/nearest", 0.41):

        def first_line() -> str:
            return run("check", str(file)).out.splitlines()[0]

        wait_until(lambda: first_line() == f"▲ {said}", 10, "the check to know")
        assert run("backtest", str(file)).out.splitlines()[0] == f"▲ {said}"
        applied = run("apply", str(file), "--yes", "--probation", "off", "--json")
        revision = json.loads(applied.out)["revision"]
        wait_until(lambda: "too-near" in run("firings").out, 10, "the rule to fire")
    (firing,) = json.loads(run("firings", "--rule", "too-near", "--json").out)["firings"]
    history = json.loads(run("history", "--json").out)["revisions"]
    (made,) = (each for each in history if each["number"] == revision)
    assert firing["time"] - made["time"] == pytest.approx(2.05, abs=0.5)
    assert run("rollback", "--yes").code == 0


@pytest.mark.ros
@pytest.mark.parametrize("arguments", [["--namespace", "/r7"], ["--domain-id", "101"]])
def test_without_a_monitor_it_says_what_to_do(
    stack: Stack,
    arguments: list[str],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", str(stack.domain))
    monkeypatch.setattr("kompass_console.rules_cli.connection.SEARCH", 1.0)
    found = in_this_process(capsys, "show", *arguments)
    assert found.code == 1
    assert "no monitor was found on ROS domain" in found.error
    assert "start a stack with 'kompass-console run'" in found.error


@pytest.mark.ros
def test_the_real_command_ends_with_its_exit_code_and_one_line(
    stack: Stack, tmp_path: Path
) -> None:
    command = [str(Path(sys.executable).with_name("kompass-console")), "rules"]
    environment = {**os.environ, "ROS_DOMAIN_ID": str(stack.domain)}

    def end(*arguments: str) -> Any:
        return subprocess.run(
            [*command, *arguments], env=environment, capture_output=True, text=True, timeout=60
        )

    shown = end("show", "--json", "--namespace", "/")
    assert (shown.returncode, shown.stderr) == (0, "")
    Table.model_validate(json.loads(shown.stdout)["table"])
    wrong = end("check", str(tmp_path / "none.yaml"))
    assert (wrong.returncode, wrong.stdout) == (2, "")
    assert wrong.stderr.count("\n") == 1
    assert "none.yaml: No such file" in wrong.stderr


# -- files, without a robot -----------------------------------------------------------------------

GOOD = f"rules:{MORE.replace(chr(10), chr(10) + '  ')}"


@pytest.mark.parametrize(
    ("change", "line", "words"),
    [
        (
            ("value: true", "valu: true"),
            5,
            ["'more'", "condition.value", "bad.yaml:8: rule 'more'"],
        ),
        (("kind: log", "kind: lok"), 10, ["'more'", "actions[0]", "'log'"]),
        (("id: more", "id: More!"), 2, ["id", '"More!"']),
        (("operator", "operator: '<'\n        operator"), 8, ["'operator' is given twice"]),
        (("text: more", "text: [unclosed"), 12, ["expected"]),
        (("text: more", "text: 2026-01-01"), None, ["quotation marks"]),
        (("rules:", "rulez:"), None, ["no table of rules", "rules export"]),
    ],
)
def test_a_bad_file_names_line_rule_field_and_remedy(
    tmp_path: Path, change: tuple[str, str], line: int | None, words: list[str]
) -> None:
    file = tmp_path / "bad.yaml"
    file.write_text(GOOD.replace(*change, 1))
    with pytest.raises(CliError) as found:
        TableFile(file)
    assert found.value.code == 2
    text = str(found.value)
    assert text.startswith(f"{file}:{line}: " if line else f"{file}")
    assert all(word in text for word in words), text


@pytest.mark.parametrize("form", ["json", "tabs.json", "yaml", "list.yaml"])
def test_json_and_yaml_are_read_alike(tmp_path: Path, form: str) -> None:
    data = yaml.safe_load(GOOD)
    file = tmp_path / f"table.{form}"
    if form == "list.yaml":
        file.write_text(yaml.safe_dump(data["rules"]))
    elif form == "yaml":
        file.write_text(GOOD)
    else:
        file.write_text(json.dumps(data, indent="\t" if form == "tabs.json" else 2))
    assert TableFile(file).table == Table.model_validate(data)
    assert TableFile(file).line("more", "actions[0].text") > 1


@pytest.mark.parametrize(
    "content", [b"\xff\xfe", b"", b"- - -", b"{" * 500, b"rules: 3", b"&a [*a]"]
)
def test_files_that_are_no_tables_are_refused(tmp_path: Path, content: bytes) -> None:
    file = tmp_path / "table.yaml"
    file.write_bytes(content)
    with pytest.raises(CliError) as found:
        TableFile(file)
    assert found.value.code == 2


def test_probation_is_seconds_or_off() -> None:
    from kompass_console.rules_cli.options import probation_seconds

    assert [probation_seconds(text) for text in ("off", "30", "2.5s", "default")] == [
        0.0,
        30.0,
        2.5,
        -1.0,
    ]
    for text in ("0", "-3", "soon", "nan", "1e9"):
        with pytest.raises(CliError, match="give seconds"):
            probation_seconds(text)
