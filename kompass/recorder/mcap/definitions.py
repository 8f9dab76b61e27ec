"""The text of a ROS message definition with all that it refers to, as MCAP files carry it.

With it a file stands alone: any tool reads its messages without having their packages.
"""

import re
from functools import cache
from pathlib import Path

from ament_index_python.packages import PackageNotFoundError, get_package_share_directory

_BAR = "=" * 80
_FIELD = re.compile(r"^\s*([A-Za-z][\w/]*)")
_PRIMITIVES = frozenset({"bool", "byte", "char", "string", "wstring"})
_NUMBER = re.compile(r"(float|u?int)\d+")


@cache
def definition(type_name: str) -> str:
    """Return the definition of ``package/msg/Name``, followed by those of its parts.

    Empty when a definition is not installed: the messages are recorded all the same, and read by
    whoever has the package.
    """
    texts: dict[str, str] = {}
    waiting = [_short(type_name)]
    while waiting:
        name = waiting.pop(0)
        if name in texts:
            continue
        text = _text(name)
        if text is None:
            return ""
        texts[name] = text
        waiting += _parts(text, name.partition("/")[0])
    (_, first), *others = texts.items()
    return first + "".join(f"{_BAR}\nMSG: {name}\n{text}" for name, text in others)


def _short(type_name: str) -> str:
    package, *_, name = type_name.split("/")
    return f"{package}/{name}"


def _text(name: str) -> str | None:
    package, bare = name.split("/")
    try:
        path = Path(get_package_share_directory(package), "msg", f"{bare}.msg")
        text = path.read_text()
    except (PackageNotFoundError, ValueError, OSError):
        return None
    return text if text.endswith("\n") else text + "\n"


def _parts(text: str, package: str) -> list[str]:
    """Types that a definition refers to, in full."""
    found = []
    for line in text.splitlines():
        field = _FIELD.match(line.partition("#")[0])
        if field is None or field[1] in _PRIMITIVES or _NUMBER.fullmatch(field[1]):
            continue
        name = _short(field[1]) if "/" in field[1] else f"{package}/{field[1]}"
        found.append("std_msgs/Header" if field[1] == "Header" else name)
    return found
