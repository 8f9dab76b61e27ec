"""``LoadMap()`` instead of ``LoadMap.Request()``.

A published tutorial fills an instance of the service class itself. rclpy's service classes refuse
to be instantiated; here the instance is the request, which is what the tutorial means.
"""

from typing import Any

import nav2_msgs.srv as nav2_services


def make_services_instantiable() -> None:
    """Let the services that recipes name stand for their requests."""
    for name in ("LoadMap", "ClearEntireCostmap"):
        service = getattr(nav2_services, name, None)
        if service is not None:
            service.__new__ = staticmethod(_request)


def _request(cls: Any, *args: Any, **kwargs: Any) -> Any:
    return cls.Request(*args, **kwargs)
