"""The rule engine: pure functions over rules as data; no ROS, no clock, no threads, no I/O.

:func:`step` takes a message, the passing of time or the end of a run, and returns what fires. A
shell feeds it and carries out the firings; nothing else decides whether a rule fires.
"""
