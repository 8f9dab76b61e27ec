"""From range readings to a local map and to obstacle points."""
