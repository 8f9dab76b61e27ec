"""A request as bytes: the same for equal requests, on every machine, and for no others."""

import json
import struct
from collections.abc import Iterable
from typing import Any

_WHOLE = ("sequence<int", "sequence<uint")
PROOF = "proof"  # the field that holds the proof, and cannot prove itself


def canonical_bytes(request: Any) -> bytes:
    """Every field of a message but its proof, by name.

    The bytes that the middleware sends are no help: what lies between their fields is undefined.

    Parameters
    ----------
    request
        A message, or the request of a service, or the goal of an action.
    """
    plain = _fields(request)
    plain.pop(PROOF, None)
    return json.dumps(plain, separators=(",", ":"), sort_keys=True).encode()


def _fields(message: Any) -> dict[str, Any]:
    kinds = message.get_fields_and_field_types()
    return {name: _plain(getattr(message, name), kind) for name, kind in kinds.items()}


def _plain(value: Any, kind: str) -> Any:
    if isinstance(value, str):
        return value.partition("\0")[0]  # as far as ROS carries it
    if isinstance(value, bool | int):
        return value
    if isinstance(value, float):
        # The wire rounds a float32, and a proof must survive it.
        single = kind.startswith(("float", "sequence<float"))
        return (struct.unpack("<f", struct.pack("<f", value))[0] if single else value).hex()
    if isinstance(value, bytes):
        return value.hex()
    if hasattr(value, "get_fields_and_field_types"):
        return _fields(value)
    values: Iterable[Any] = value.tolist() if hasattr(value, "tolist") else value
    if kind.startswith(_WHOLE):
        return list(values)  # there may be thousands of them
    return [_plain(each, kind) for each in values]
