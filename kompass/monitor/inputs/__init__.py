"""What rules look at: topics, and polled functions of the recipe."""
