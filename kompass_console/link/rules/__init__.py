"""The rules of the robot: its monitor, back-tests, and conditions that are being written."""
