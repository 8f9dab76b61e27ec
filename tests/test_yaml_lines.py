"""YAML is read strictly, and whatever is wrong has its line."""

from pathlib import Path

import pytest

from kompass.yaml_lines import BadYaml, child, farthest, line_of, read_yaml
from kompass_console.cli_error import CliError
from kompass_console.rules_cli.table_file import TableFile

TEXT = """\
rules:
  - id: first
    event:
      hold: 2.0
"""


def test_what_stands_somewhere_has_its_line_or_that_of_the_last_there_is_of_the_way() -> None:
    root, data = read_yaml(TEXT)
    assert data["rules"][0]["event"] == {"hold": 2.0}
    hold = farthest(root, ["rules", "0", "event", "hold"])
    assert hold is not None
    assert line_of(hold) == 4
    event = farthest(root, ["rules", "0", "event", "cooldown", "x"])
    assert event is child(child(child(root, "rules"), "0"), "event")
    assert child(root, "roles") is None
    assert read_yaml("") == (None, None)


@pytest.mark.parametrize(
    ("text", "line", "said"),
    [
        ("a: 1\nb: 2\na: 3\n", 3, "'a' is given twice; keep one"),
        ("a: [1\n", 2, "expected ',' or ']'"),
        ("a: 1\nb: 2026-13-01\n", 2, "'2026-13-01' cannot be read: month must be in 1..12; corr"),
        (f"a: 1\nb: {'9' * 5000}\n", 2, "value has 5000 digits; correct it"),
        ("a: 1\nb: !!bool perhaps\n", 2, "'perhaps' cannot be read: it is no bool; correct it"),
        ("a: 1\nb: !!timestamp soon\n", 2, "'soon' cannot be read: it is no timestamp; correct it"),
        ("a: 1\nb: !!int ''\n", 2, "'' cannot be read: it is no int; correct it"),
    ],
)
def test_what_cannot_be_read_is_said_with_its_line(text: str, line: int | None, said: str) -> None:
    with pytest.raises(BadYaml) as caught:
        read_yaml(text)
    assert said in str(caught.value)
    assert caught.value.line == line


def laughs(levels: int) -> str:
    """A few lines that stand for 9 to the power of ``levels`` values."""
    lines = ["a0: &a0 lol"]
    for level in range(1, levels + 1):
        inner = ", ".join([f"*a{level - 1}"] * 9)
        lines.append(f"a{level}: &a{level} [{inner}]")
    return "\n".join(lines)


@pytest.mark.parametrize(
    ("text", "line", "said"),
    [
        ("[" * 100_000, None, "nested too deeply"),
        (laughs(12), 7, "its aliases come to more than 100000 values"),
        ("a: &a [1, *a]\n", 1, "an alias stands for what it is in"),
    ],
    ids=["deep", "laughs", "circle"],
)
def test_what_would_take_for_ever_is_refused_at_once(
    text: str, line: int | None, said: str
) -> None:
    with pytest.raises(BadYaml, match=said) as caught:
        read_yaml(text)
    assert caught.value.line == line


def test_an_alias_is_what_it_stands_for() -> None:
    assert read_yaml("a: &a {b: 1}\nc: *a\n")[1] == {"a": {"b": 1}, "c": {"b": 1}}


def test_a_table_with_a_date_that_is_none_is_refused_in_a_sentence(tmp_path: Path) -> None:
    file = tmp_path / "rules.yaml"
    file.write_text("rules: 2026-13-01\n", encoding="utf-8")
    with pytest.raises(CliError, match=r"rules.yaml:1: '2026-13-01' cannot be read: month"):
        TableFile(file)
