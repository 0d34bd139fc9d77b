"""The allocation problem and how its optimum is found and vouched for; no ROS."""
