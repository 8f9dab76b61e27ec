"""The named events of recipes: ``event.OnEqual("name", topic, value, "field")``."""

from kompass.porting import absent_names
from kompass.recipe.event import (
    Event,
    OnAny,
    OnChange,
    OnChangeContainsAll,
    OnChangeContainsAny,
    OnChangeEqual,
    OnChangeNotContain,
    OnContainsAll,
    OnContainsAny,
    OnDifferent,
    OnEqual,
    OnGreater,
    OnLess,
)

__all__ = [
    "Event",
    "OnAny",
    "OnChange",
    "OnChangeContainsAll",
    "OnChangeContainsAny",
    "OnChangeEqual",
    "OnChangeNotContain",
    "OnContainsAll",
    "OnContainsAny",
    "OnDifferent",
    "OnEqual",
    "OnGreater",
    "OnLess",
]

__getattr__ = absent_names("kompass.event")
