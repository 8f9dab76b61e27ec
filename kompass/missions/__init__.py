"""Missions: lists of places that the robot goes to, and what it does there. Pure."""
