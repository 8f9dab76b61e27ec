"""What is told of rules: firings, their states, explanations, and who cannot speak."""
