"""The file of webhooks: who may be told of what, and what is refused in a sentence."""

from pathlib import Path

import pytest

from kompass_console.webhooks.notice import KINDS
from kompass_console.webhooks.settings import BadWebhooks, may_be_told, read_webhooks


def written(folder: Path, text: str, mode: int = 0o600) -> Path:
    file = folder / "webhooks.yaml"
    file.write_text(text, encoding="utf-8")
    file.chmod(mode)
    return file


def test_a_webhook_is_told_of_all_or_of_what_it_names_and_hides_its_path(tmp_path: Path) -> None:
    text = """
webhooks:
  - url: https://hooks.example/T0/secret?key=1
  - url: http://10.0.0.9:8000/robots
    secret: sixteen characters
    kinds: [stop, battery]
"""
    first, second = read_webhooks(written(tmp_path, text))
    assert (first.kinds, first.secret) == (KINDS, None)
    assert second.kinds == ("stop", "battery")
    assert first.place == "https://hooks.example"
    assert "secret" not in repr(first)
    assert "sixteen" not in repr(second)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "the file:"),
        ("webhooks: []", "webhooks:"),
        ("webhooks: [{url: 'ftp://a/b'}]", "webhooks.0.url: is no address of the web"),
        ("webhooks: [{url: 'https:///b'}]", "webhooks.0.url: is no address of the web"),
        ("webhooks: [{url: 'https://a..b/c'}]", "webhooks.0.url: is no address"),
        ("webhooks: [{url: 'https://a:99999/b'}]", "webhooks.0.url: is no address"),
        ("webhooks: [{url: 'https://me:pw@a/b'}]", "a name, a password or a # part"),
        ('webhooks: [{url: "https://a/b\\r\\nHost: c"}]', "has blanks or letters"),
        ("webhooks: [{url: 'https://a', secret: short}]", "webhooks.0.secret"),
        ("webhooks: [{url: 'https://a', kinds: [fire]}]", "webhooks.0.kinds.0"),
        ("webhooks: [{url: 'https://a', to: b}]", "webhooks.0.to"),
        ("webhooks: [", "webhooks.yaml"),
    ],
)
def test_what_cannot_be_is_refused_with_its_field(tmp_path: Path, text: str, said: str) -> None:
    with pytest.raises(BadWebhooks) as refused:
        read_webhooks(written(tmp_path, text))
    assert said in str(refused.value)
    assert "short" not in str(refused.value)  # what was refused may be a secret


def test_a_file_that_others_may_read_is_refused(tmp_path: Path) -> None:
    with pytest.raises(BadWebhooks, match="chmod 600"):
        read_webhooks(written(tmp_path, "webhooks: [{url: 'https://a'}]", 0o640))
    with pytest.raises(BadWebhooks, match="No such file"):
        read_webhooks(tmp_path / "nowhere.yaml")


@pytest.mark.parametrize(
    ("address", "plain_text", "over_tls"),
    [
        ("127.0.0.1", True, True),
        ("::1", True, True),
        ("10.1.2.3", True, True),
        ("192.168.0.9", True, True),
        ("fd00::7", True, True),
        ("93.184.215.14", False, True),
        ("2606:2800:21f::1", False, True),
        ("::ffff:93.184.215.14", False, True),
        ("169.254.169.254", False, False),
        ("::ffff:169.254.169.254", False, False),
        ("fe80::1%eth0", False, False),
        ("0.0.0.0", False, False),
        ("224.0.0.1", False, False),
    ],
)
def test_what_is_not_encrypted_stays_near_and_some_addresses_are_never_told(
    address: str, plain_text: bool, over_tls: bool
) -> None:
    assert may_be_told(address, over_tls=False) == plain_text
    assert may_be_told(address, over_tls=True) == over_tls
