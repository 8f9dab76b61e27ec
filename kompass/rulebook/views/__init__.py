"""Rules, their state and their firings, put into the words and models that are shown."""
