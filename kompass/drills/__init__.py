"""Drills: drives with something going wrong, by seed, and what a table of rules made of each.

Here is all of it that needs no robot: what a drive is to be (:mod:`~kompass.drills.scenario`,
:mod:`~kompass.drills.draw`), how what was observed of it is judged (:mod:`~kompass.drills.judge`,
:mod:`~kompass.drills.invariants`), and what is said of many (:mod:`~kompass.drills.summary`,
:mod:`~kompass.drills.compare`, :mod:`~kompass.drills.requirement`, the reports). No ROS, no clock,
no threads: time is a number of seconds since the drive's start, and chance comes from a seed.
"""
