"""Parameters of a vehicle: types, table, files, and what is built from them; no ROS."""
