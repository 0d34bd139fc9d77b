"""Programs that find no ROS, as on a machine without it."""

import re

ROS = re.compile(r'(rcl\w*|ament_\w+|ros(?!bags)\w+|launch\w*|\w+_(msgs|srvs|interfaces))(\..*)?')

# The beginning of such a program
HIDE = f"""
import importlib, re, sys

class Hidden:
    def find_spec(self, name, path=None, target=None):
        if re.fullmatch({ROS.pattern!r}, name):
            raise ModuleNotFoundError(f'No module named {{name!r}}', name=name)

sys.meta_path.insert(0, Hidden())
"""
