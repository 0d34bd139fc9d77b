"""
Thrust allocation for underwater vehicles, with thrust bounds that move with the vehicle's speed.

Data flows one way: YAML file (`parameter_file`) -> checked values (`parameters`) -> `vehicle`
-> `bounds` -> `allocation` (the QP) -> messages (`node`). Only `node` and `demo` import ROS.
"""
