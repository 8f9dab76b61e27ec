"""Rules as data: signals, conditions, events, actions, tables."""
