"""`replay`: a recorded mission once more through the node's own tick; no ROS."""
