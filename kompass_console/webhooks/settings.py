"""Which addresses are told of what: a file of the engineer's."""

from __future__ import annotations

import ipaddress
import stat
from pathlib import Path
from typing import Annotated
from urllib.parse import SplitResult, urlsplit

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator

from kompass.invalid import first_invalid
from kompass.yaml_lines import BadYaml, read_yaml
from kompass_console.webhooks.notice import KINDS, Kind

MOST = 8  # webhooks of a console

_LONGEST_URL = 2000
_SHORTEST_SECRET = 16


class BadWebhooks(ValueError):
    """The file cannot be used; the message says where, why, and what to do."""


class Webhook(BaseModel):
    """One address.

    Attributes
    ----------
    url
        https, or http where the address is this machine's own or of a private network.
    secret
        With which each request is signed; None for unsigned ones.
    kinds
        Of notices that it is told of.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    url: str = Field(max_length=_LONGEST_URL, repr=False)
    secret: str | None = Field(default=None, min_length=_SHORTEST_SECRET, repr=False)
    kinds: Annotated[tuple[Kind, ...], Field(min_length=1)] = KINDS

    @field_validator("url")
    @classmethod
    def _can_be_asked(cls, url: str) -> str:
        try:
            parts = urlsplit(url)
            port = parts.port
            (parts.hostname or "").encode("idna")  # as it is looked up
        except ValueError as error:
            raise ValueError(f"is no address ({error}); write https://host/path") from None
        if parts.scheme not in ("http", "https") or not parts.hostname or port == 0:
            raise ValueError("is no address of the web; write https://host/path")
        if not url.isascii() or not url.isprintable() or " " in url:
            raise ValueError("has blanks or letters that an address cannot have; encode them (%20)")
        if parts.username is not None or parts.fragment:
            raise ValueError("has a name, a password or a # part; leave them out, use 'secret'")
        return url

    @property
    def parts(self) -> SplitResult:
        """The address, taken apart."""
        return urlsplit(self.url)

    @property
    def place(self) -> str:
        """What may be shown of the address: paths and queries are often secrets."""
        parts = self.parts
        return f"{parts.scheme}://{parts.netloc}"


class _File(BaseModel):
    model_config = ConfigDict(extra="forbid")

    webhooks: Annotated[list[Webhook], Field(min_length=1, max_length=MOST)]


def read_webhooks(file: Path) -> tuple[Webhook, ...]:
    """The webhooks of a file.

    Raises
    ------
    BadWebhooks
        It is not there, is no such file, or others may read it.
    """
    try:
        if stat.S_IMODE(file.stat().st_mode) & 0o077:
            raise BadWebhooks(f"{file} can be read by others, and has secrets: chmod 600 {file}")
        text = file.read_text(encoding="utf-8")
    except OSError as error:
        raise BadWebhooks(f"cannot read {file}: {error.strerror}") from None
    except UnicodeDecodeError:
        raise BadWebhooks(f"{file} is no text in UTF-8; write it anew") from None
    try:
        _, data = read_yaml(text)
        return tuple(_File.model_validate(data).webhooks)
    except BadYaml as error:
        raise BadWebhooks(f"{error.at(str(file))}: {error}") from None
    except ValidationError as error:
        wrong = first_invalid(error)
        # What was refused may be a secret, or have one in it.
        raise BadWebhooks(f"{file}: {wrong.where or 'the file'}: {wrong.text}") from None


def may_be_told(address: str, *, over_tls: bool) -> bool:
    """Whether a notice may go to an address, now that its name is known to mean that one.

    What is not encrypted stays on this machine or on a private network. Link-local addresses are
    neither: there are services of clouds that hand out keys to whoever asks.
    """
    ip = ipaddress.ip_address(address.partition("%")[0])
    if isinstance(ip, ipaddress.IPv6Address) and ip.ipv4_mapped is not None:
        ip = ip.ipv4_mapped
    if ip.is_loopback:
        return True
    if ip.is_link_local or ip.is_multicast or ip.is_unspecified or ip.is_reserved:
        return False
    return over_tls or ip.is_private
