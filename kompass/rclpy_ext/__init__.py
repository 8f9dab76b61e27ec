"""What rclpy and DDS lack or get wrong, each mended in one place."""
