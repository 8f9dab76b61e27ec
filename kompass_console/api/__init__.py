"""What the browser talks to: HTTP routes and websockets, and the models that are their contract."""
