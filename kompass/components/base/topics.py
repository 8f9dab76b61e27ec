"""The topics that a component is declared with: by key, in a fixed direction."""

from collections.abc import Iterator, Mapping

from kompass.rclpy_ext.topic import AllowedTopics, Topic

Given = Mapping[str, Topic | list[Topic]]


class DeclaredTopics:
    """Topics of one direction of a component, by key. It exists without ROS.

    Parameters
    ----------
    owner
        Name of the component, for messages.
    direction
        "input" or "output", for messages.
    allowed
        The keys that there are, and what each takes.
    default
        Topics of keys that nobody speaks of.
    """

    def __init__(
        self,
        owner: str,
        direction: str,
        allowed: Mapping[str, AllowedTopics],
        default: Mapping[str, list[Topic]],
    ) -> None:
        self.allowed = allowed
        self._owner = owner
        self._direction = direction
        self._topics = {key: list(topics) for key, topics in default.items()}

    def __getitem__(self, key: str) -> list[Topic]:
        return self._topics[key]

    def items(self) -> Iterator[tuple[str, list[Topic]]]:
        """Keys and their topics."""
        yield from self._topics.items()

    def replace(self, given: Given) -> None:
        """Use other topics for some keys.

        Raises
        ------
        ValueError, TypeError
            When a key or a topic is not allowed; nothing changes then.
        """
        checked = {}
        for key, value in given.items():
            if key not in self.allowed:
                raise ValueError(
                    f"{self._owner}: '{key}' is not an {self._direction}; "
                    f"known are {', '.join(self.allowed)}"
                )
            checked[key] = list(value) if isinstance(value, list | tuple) else [value]
            self.allowed[key].check(self._owner, key, checked[key])
        self._topics.update(checked)

    def replace_known(self, given: Given) -> bool:
        """As :meth:`replace`; False, and no change, when one of the keys does not exist."""
        if not set(given) <= set(self.allowed):
            return False
        self.replace(given)
        return True

    def replace_one(self, key: str, index: int, topic: Topic) -> None:
        """Use another topic in one place of a key; raises as :meth:`replace`."""
        topics = list(self._topics.get(key, []))
        topics[index : index + 1] = [topic]
        self.replace({key: topics})

    def place_of(self, name: str) -> tuple[str, int]:
        """Key and index of a topic's name, with or without the leading slash.

        Raises
        ------
        ValueError
            When no key uses it.
        """
        wanted = name.strip().removeprefix("/")
        for key, topics in self._topics.items():
            for index, used in enumerate(topics):
                if used.name == wanted:
                    return key, index
        names = ", ".join(f"/{used.name}" for topics in self._topics.values() for used in topics)
        raise ValueError(
            f"{self._owner}: no {self._direction} uses '{name}'; those in use are {names}"
        )

    def topic(self, key: str) -> Topic | list[Topic] | None:
        """The topic of a key; a list when there are several, None when there is none.

        ``key`` may be a member of an enum whose value is the key.
        """
        topics = self._topics.get(str(getattr(key, "value", key)), [])
        return topics[0] if len(topics) == 1 else (list(topics) or None)

    def topic_name(self, key: str) -> str | list[str] | None:
        """As :meth:`topic`, names only."""
        topic = self.topic(key)
        if isinstance(topic, list):
            return [one.name for one in topic]
        return topic.name if topic is not None else None
