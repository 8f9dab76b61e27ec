"""The base of components that were written for Sugarcoat: another order of the arguments."""

from collections.abc import Mapping, Sequence
from typing import Any

from kompass.components.base.component import Component
from kompass.components.base.component_config import ComponentConfig
from kompass.rclpy_ext.topic import Topic

# What may follow by position; older releases had a truth value before these.
_MORE = ("fallbacks", "main_action_type", "main_srv_type")
_BROADCAST = "enable_health_broadcast"


class BaseComponent(Component):
    """As :class:`Component`; by position, topics come before the settings.

    Parameters
    ----------
    component_name, inputs, outputs, config, config_file, callback_group
        See :class:`Component`.
    more
        ``fallbacks``, ``main_action_type`` and ``main_srv_type``; ``enable_health_broadcast`` may
        come before them.

    Raises
    ------
    TypeError
        When there is more than that, and as of :class:`Component`.
    """

    def __init__(
        self,
        component_name: str | None = None,
        inputs: Mapping[str, Topic | list[Topic]] | Sequence[Topic] | None = None,
        outputs: Mapping[str, Topic | list[Topic]] | Sequence[Topic] | None = None,
        config: ComponentConfig | None = None,
        config_file: str | None = None,
        callback_group: Any = None,
        *more: Any,
        **kwargs: Any,
    ) -> None:
        names = (_BROADCAST, *_MORE) if more and isinstance(more[0], bool) else _MORE
        if len(more) > len(names):
            raise TypeError(
                f"{component_name}: {more[len(names) :]!r} is too much; after callback_group come "
                f"{', '.join(names)}"
            )
        super().__init__(
            component_name,
            config,
            config_file,
            inputs,
            outputs,
            callback_group=callback_group,
            **dict(zip(names, more, strict=False)),
            **kwargs,
        )
