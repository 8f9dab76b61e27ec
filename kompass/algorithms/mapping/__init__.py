"""From range readings to a local map and to obstacle points."""

from kompass.algorithms.mapping.local_map import LocalMapBuilder
from kompass.algorithms.mapping.scan_points import scan_to_points

__all__ = ["LocalMapBuilder", "scan_to_points"]
