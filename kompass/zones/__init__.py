"""Keep-out and speed zones of a map: what they are, how they change, what they forbid. Pure."""
