"""From range readings to a local map and to obstacle points."""

from kompass.algorithms.mapping.local_map import LocalMapper
from kompass.algorithms.mapping.scan_points import scan_to_points

__all__ = ["LocalMapper", "scan_to_points"]
