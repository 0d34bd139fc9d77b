"""`import_vehicle`: a parameter file from a simulator's model, a matrix or a layout; no ROS."""
