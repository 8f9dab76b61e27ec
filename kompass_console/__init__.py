"""Kompass Console: the browser page from which people drive and heal their ROS 2 robots."""

from importlib.metadata import version

__version__ = version("kompass-console")
