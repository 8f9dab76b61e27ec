"""The robot's sensors, each an object of its own so that one can be replaced without the others."""
