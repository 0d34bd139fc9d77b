"""The importer runs where no ROS is installed."""

from support.importing import sdf, sdf_thruster
from support.processes import run
from support.without_ros import HIDE


def test_it_needs_no_ros(tmp_path):
    """It imports a vehicle with every module of ROS hidden."""
    (tmp_path / 'auv.sdf').write_text(sdf(sdf_thruster('t', '0 0 0 0 0 0')))
    done = run('-c', HIDE + 'from thrust_allocator.__main__ import main\n'
               f'sys.exit(main(["x", "import_vehicle", {str(tmp_path / "auv.sdf")!r}, "--output", '
               f'{str(tmp_path / "mine.yaml")!r}]))')
    assert done.returncode == 0 and '1 thrusters from' in done.stdout, done.stderr
