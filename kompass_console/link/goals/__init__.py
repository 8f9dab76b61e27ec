"""Goals: sent, followed to their end, cancelled."""
