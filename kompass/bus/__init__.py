"""What the programs of a robot reach the world through: a clock, and a node on a bus."""
