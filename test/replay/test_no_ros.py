"""The replay runs where no ROS is installed."""

from support.bags import mission, write
from support.processes import run
from support.without_ros import HIDE


def test_it_needs_no_ros(mt2012, tmp_path):
    """It replays a bag, pictures and all, with every module of ROS hidden."""
    bag = write(tmp_path / 'bag', mission(0.5))
    done = run('-c', HIDE + 'from thrust_allocator.__main__ import main\n'
               f'sys.exit(main(["x", "replay", {str(bag)!r}, {str(mt2012)!r}, "--output", '
               f'{str(tmp_path / "out")!r}]))')
    assert done.returncode == 0 and 'mt2012: ' in done.stdout, done.stderr
    report = (tmp_path / 'out' / 'report.md').read_text('utf-8')
    for name in ('setpoints', 'saturated', 'wrench', 'motion'):
        assert (tmp_path / 'out' / f'{name}.png').read_bytes().startswith(b'\x89PNG')
        assert f'({name}.png)' in report
