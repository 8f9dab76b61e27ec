"""The zones of the robot's map, as the monitor tells them, for the components that move it."""

from collections.abc import Callable, Sequence

from pydantic import ValidationError
from std_msgs.msg import String

from kompass.bus.node import LifecycleNode
from kompass.invalid import first_invalid
from kompass.rclpy_ext.topic import LATCHED
from kompass.zones.in_force import ZonesInForce
from kompass.zones.mask import MaskInForce
from kompass.zones.zone import ZonesNow

TOPIC = "zones"
_LONGEST = 2_000_000  # characters; the most zones with the most corners have a tenth


class ZonesHeard:
    """Hears of the zones from its making on; what was heard last counts until something else is.

    Parameters
    ----------
    node
        Listens.
    changed
        Called after others have come into force.

    Attributes
    ----------
    now
        Those in force, and the masks of the recipe.
    told
        As they were told; None before anything was.
    masks
        Those of the recipe.
    """

    def __init__(self, node: LifecycleNode, changed: Callable[[], None] = lambda: None) -> None:
        self.now = ZonesInForce()
        self.told: ZonesNow | None = None
        self.masks: Sequence[MaskInForce] = ()
        self._log, self._changed = node.get_logger(), changed
        node.create_subscription(String, TOPIC, self._on_zones, LATCHED.to_ros())

    def set(self, told: ZonesNow) -> None:
        """Put zones into force."""
        self.told, self.now = told, ZonesInForce(told.zones, self.masks)

    def mask_with(self, masks: Sequence[MaskInForce]) -> None:
        """Put masks into force, whatever is told of zones."""
        self.masks = masks
        self.now = ZonesInForce(() if self.told is None else self.told.zones, masks)

    def _on_zones(self, message: String) -> None:
        if len(message.data) > _LONGEST:
            self._log.error(f"/{TOPIC}: {len(message.data)} characters are no zones; ignored")
            return
        try:
            told = ZonesNow.model_validate_json(message.data)
        except ValidationError as error:
            wrong = first_invalid(error)
            self._log.error(
                f"/{TOPIC}: {wrong.where}: {wrong.text}; the zones from before stay in force"
            )
            return
        self.set(told)
        self._changed()
