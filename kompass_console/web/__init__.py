"""What the routes stand on: log-in, guards, audit, errors, and the feeds of the websockets."""
