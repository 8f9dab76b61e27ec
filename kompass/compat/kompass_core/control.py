"""Control algorithms under the older import name."""

from kompass.control import ControllersID, DWAConfig, PurePursuitConfig, StanleyConfig
from kompass.porting import absent_names

__all__ = ["ControllersID", "DWAConfig", "PurePursuitConfig", "StanleyConfig"]

__getattr__ = absent_names("kompass_core.control")
