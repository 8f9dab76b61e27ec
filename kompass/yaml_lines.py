"""YAML read strictly, with the lines on which things stand."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

import yaml
from yaml.nodes import MappingNode, Node, ScalarNode, SequenceNode

_SHORT = 40  # characters of what is quoted in an error
MOST_NODES = 100_000  # that a text with aliases may come to, each alias written out


class BadYaml(ValueError):
    """It cannot be read; the message says why, and what to do.

    Attributes
    ----------
    line
        On which; None where that is not known.
    """

    def __init__(self, text: str, line: int | None = None) -> None:
        super().__init__(text)
        self.line = line

    def at(self, where: str) -> str:
        """The place, to stand before the message: a file, with its line if that is known."""
        return where if self.line is None else f"{where}:{self.line}"


def read_yaml(text: str) -> tuple[Node | None, Any]:
    """A text as a tree of nodes with their lines, and as data; None for an empty one.

    Raises
    ------
    BadYaml
        It is no YAML, or nested too deeply; a key is given twice: the second would silently win;
        or its aliases come to more than :data:`MOST_NODES`.
    """
    try:
        loader = _Loader(text)
        try:
            root: Node | None = loader.get_single_node()
            if root is None:
                return None, None
            _check_size(root)
            for key in _doubles(root, set()):
                raise BadYaml(f"'{key.value}' is given twice; keep one", line_of(key))
            return root, loader.construct_document(root)
        finally:
            loader.dispose()
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line = mark.line + 1 if mark else None
        said = error.problem or str(error)
        if said.startswith("but "):  # the second half of a sentence
            said = f"{error.context}, {said}"
        raise BadYaml(f"{said}; correct it", line) from None
    except RecursionError:
        raise BadYaml("it is nested too deeply to be read; write it with fewer levels") from None
    except yaml.YAMLError as error:
        raise BadYaml(f"{' '.join(str(error).split())}; correct it") from None


class _Loader(yaml.SafeLoader):
    """Says on which line something stands that looks like a value and is none: 2026-13-01."""

    def construct_object(self, node: Node, deep: bool = False) -> Any:
        try:
            return super().construct_object(node, deep)
        except (BadYaml, yaml.YAMLError):
            raise
        # What a tag asks for and the text is not, pyyaml finds by running into it.
        except (ValueError, AttributeError, LookupError, TypeError) as error:
            kind = node.tag.rpartition(":")[2]
            why = str(error).partition(";")[0] if type(error) is ValueError else f"it is no {kind}"
            text = str(node.value)
            written = text if len(text) <= _SHORT else f"{text[:_SHORT]}…"
            raise BadYaml(
                f"{written!r} cannot be read: {why}; correct it, or quote it if it is text",
                line_of(node),
            ) from None


def child(node: Node | None, step: str) -> Node | None:
    """What a mapping has under a key, or a list at an index; None for nothing."""
    if isinstance(node, MappingNode):
        return next((value for key, value in node.value if is_scalar(key, step)), None)
    if isinstance(node, SequenceNode) and step.isdigit() and int(step) < len(node.value):
        found: Node = node.value[int(step)]
        return found
    return None


def farthest(node: Node | None, steps: Iterable[str]) -> Node | None:
    """What stands at the end of a way, or the last that there is of it."""
    for step in steps:
        inner = child(node, step)
        if inner is None:
            break
        node = inner
    return node


def is_scalar(node: Node | None, value: str) -> bool:
    """Whether a value stands there, as it is written."""
    return isinstance(node, ScalarNode) and node.value == value


def line_of(node: Node) -> int:
    """The line on which it begins, from 1."""
    line: int = node.start_mark.line
    return line + 1


def _check_size(root: Node) -> None:
    """Refuse aliases that stand for more than anybody writes: a few lines can come to billions."""
    sizes: dict[Node, int] = {}  # with each alias written out; 0 for one that is being counted

    def size(node: Node) -> int:
        if node in sizes:
            if not sizes[node]:
                raise BadYaml("an alias stands for what it is in; write it out", line_of(node))
            return sizes[node]
        sizes[node] = 0
        inner = node.value if isinstance(node, MappingNode | SequenceNode) else ()
        count = 1
        for each in inner:
            count += sum(map(size, each)) if isinstance(each, tuple) else size(each)
        sizes[node] = count
        return count

    if size(root) > max(MOST_NODES, len(sizes)):
        first = min((each for each in sizes if sizes[each] > MOST_NODES), key=sizes.__getitem__)
        raise BadYaml(
            f"its aliases come to more than {MOST_NODES} values; write out what is meant",
            line_of(first),
        )


def _doubles(node: Node, seen_nodes: set[Node]) -> Iterator[ScalarNode]:
    """Keys that are given twice; what an alias stands for is looked at once."""
    if node in seen_nodes:
        return
    seen_nodes.add(node)
    if isinstance(node, MappingNode):
        seen: set[str] = set()
        for key, value in node.value:
            if isinstance(key, ScalarNode):
                if key.value in seen:
                    yield key
                seen.add(key.value)
            yield from _doubles(value, seen_nodes)
    elif isinstance(node, SequenceNode):
        for item in node.value:
            yield from _doubles(item, seen_nodes)
