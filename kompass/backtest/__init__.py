"""What a table would have done on a recording: the same engine, fed with the same inputs."""
