"""The local map and the map server."""
