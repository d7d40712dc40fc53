"""The ROS 2 side: everything that imports rclpy lives here and nowhere below."""
