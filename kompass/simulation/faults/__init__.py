"""Everything that can go wrong with the embedded robot, on request."""
