"""What happens to the robot, told to addresses that an engineer has named."""
