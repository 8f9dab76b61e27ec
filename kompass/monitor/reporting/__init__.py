"""What is told of rules and processes: firings, alarms, explanations, states."""
