"""``kompass-console rules …``: the rules of a running robot, from any machine of its domain."""
