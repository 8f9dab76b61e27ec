"""What the running robot consists of, in the terms in which rules are checked."""
