"""Where planners tell of goals: that they pursue one, and how that ended."""

from kompass.rclpy_ext.topic import LATCHED, QoSConfig

GOAL_REPORTS = "goal_reports"  # topic; kompass.timeline's GoalReport as JSON in a String
# Whoever comes late hears how the last goals ended.
REPORTS = QoSConfig(queue_size=20, durability=LATCHED.durability)
