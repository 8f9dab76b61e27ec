"""What all reading from the graph stands on: who is there, subscriptions, calls, conversions."""
