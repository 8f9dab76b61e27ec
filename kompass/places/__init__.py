"""Named places of a map: what they are, and how they change. Pure."""
