"""The topics that a component is declared with: by key, in a fixed direction."""

from collections.abc import Iterator, Mapping, Sequence

from kompass.rclpy_ext.topic import AllowedTopics, Topic

Given = Mapping[str, Topic | list[Topic]]
Allowed = Mapping[str, AllowedTopics]


def by_key(
    owner: str, direction: str, given: Given | Sequence[Topic] | None, allowed: Allowed
) -> tuple[Allowed, Given]:
    """The keys of a component, and the topics that it is made with, by these keys.

    A component that declares keys takes topics by key, or a list if each fits one key only. One
    that declares none has those that it is given: a list makes the name of each topic its key.

    Raises
    ------
    ValueError, TypeError
        When a topic fits no key or several, or is given twice.
    """
    if given is None:
        return allowed, {}
    if isinstance(given, Mapping):
        if allowed:
            return allowed, given
        listed = {
            key: list(value) if isinstance(value, list | tuple) else [value]
            for key, value in given.items()
        }
    else:
        if isinstance(given, Topic) or not isinstance(given, Sequence):
            raise TypeError(
                f"{owner}: {direction}s = {given!r}: give a list of topics, or topics by key"
            )
        listed = {}
        for topic in given:
            if not isinstance(topic, Topic):
                raise TypeError(f"{owner}: {direction}s holds {topic!r}, which is not a Topic")
            key = _key_of(owner, direction, topic, allowed) if allowed else topic.name
            if key in listed and not allowed:
                raise ValueError(f"{owner}: {direction}s names '/{topic.name}' twice")
            listed.setdefault(key, []).append(topic)
    if allowed:
        return allowed, listed
    for key, topics in listed.items():
        for topic in topics:
            if not isinstance(topic, Topic):
                raise TypeError(f"{owner}: {key} = {topic!r} is not a Topic")
    own = {
        key: AllowedTopics(sorted({topic.msg_type for topic in topics}), 1, len(topics) - 1)
        for key, topics in listed.items()
    }
    return own, listed


def _key_of(owner: str, direction: str, topic: Topic, allowed: Allowed) -> str:
    fitting = [key for key, taken in allowed.items() if topic.msg_type in taken.types]
    if len(fitting) == 1:
        return fitting[0]
    keys = ", ".join(fitting or allowed)
    why = f"fits several: {keys}" if fitting else f"fits none of {keys}"
    example = f"{direction}s={{'{(fitting or list(allowed))[0]}': Topic(…)}}"
    raise ValueError(
        f"{owner}: the {topic.msg_type} of '/{topic.name}' {why}; give {direction}s by key, "
        f"as in {example}"
    )


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
                known = ", ".join(self.allowed) or "none, so give them when it is made"
                raise ValueError(
                    f"{self._owner}: '{key}' is not an {self._direction}; known are {known}"
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
        used_names = (f"/{used.name}" for topics in self._topics.values() for used in topics)
        names = ", ".join(used_names) or "none"
        raise ValueError(
            f"{self._owner}: no {self._direction} uses '{name}'; those in use are {names}"
        )

    def find(self, name: str) -> tuple[str, int]:
        """Key and index of the topic of a key, or of a topic's name; raises as :meth:`place_of`."""
        text = str(getattr(name, "value", name))
        return (text, 0) if len(self._topics.get(text, ())) == 1 else self.place_of(text)

    def missing(self) -> list[str]:
        """Keys that need a topic and have none."""
        return [
            key
            for key, taken in self.allowed.items()
            if len(self._topics.get(key, ())) < taken.number_required
        ]

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
