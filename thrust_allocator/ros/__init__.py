"""Everything of ROS 2: the node, its topics, its parameters and its process."""
