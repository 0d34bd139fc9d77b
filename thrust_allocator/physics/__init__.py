"""What the package is about: frames, vehicles, the flow, thruster models, moving bounds; no ROS."""
