"""What has happened to a robot, on one axis: faults, stops, firings, goals, missions, edits.

Pure: what was seen comes in with its time, entries come out.
"""
