"""Addresses: which of them count as one, and what a Host header names."""

from __future__ import annotations

import ipaddress
import re

_LONGEST_OTHER = 64  # characters of what is not an address (a socket without one)
_OF_ONE_HOST = 64  # bits: whoever has one IPv6 address usually has 2⁶⁴ of them

_HOST = re.compile(r"(?:\[([0-9A-Fa-f:.]+)\]|([A-Za-z0-9._-]+))(?::([0-9]{1,5}))?")


def one_client(host: str) -> str:
    """What an address is counted by: itself, and for IPv6 its network of 64 bits."""
    try:
        address = ipaddress.ip_address(host.partition("%")[0])
    except ValueError:
        return host[:_LONGEST_OTHER]
    if isinstance(address, ipaddress.IPv4Address):
        return str(address)
    if address.ipv4_mapped is not None:
        return str(address.ipv4_mapped)
    return str(ipaddress.ip_network((address, _OF_ONE_HOST), strict=False))


def host_name(host: str) -> str | None:
    """Name in a Host header, without port and brackets and in lower case; None if it is none."""
    found = _HOST.fullmatch(host)
    if found is None or int(found[3] or 0) > 65535:
        return None
    if found[1] is None:
        return found[2].lower()
    try:
        return str(ipaddress.IPv6Address(found[1]))
    except ValueError:
        return None
