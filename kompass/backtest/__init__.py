"""What a table would have done on a recording: the same engine, fed with what it took then. Pure."""
