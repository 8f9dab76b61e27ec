"""Kompass: a ROS 2 navigation stack, its recovery rules and its launcher."""

import os
import sys

from kompass.porting import answer_absent_modules
from kompass.rclpy_ext.middleware import prepare_middleware

prepare_middleware()
answer_absent_modules()

# Numeric libraries start a thread pool at import otherwise; the supervisor forks, and a fork
# must find one thread only.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")

# ament_index looks only in AMENT_PREFIX_PATH; the ROS wheels and this package install their
# share/ under the environment's prefix.
_prefixes = [p for p in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if p]
if sys.prefix not in _prefixes:
    os.environ["AMENT_PREFIX_PATH"] = os.pathsep.join([*_prefixes, sys.prefix])
