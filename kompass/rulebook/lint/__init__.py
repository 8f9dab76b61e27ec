"""What is probably not meant so in a table."""
