"""Two descriptions of one vehicle: what they disagree about, in words."""

import numpy as np
import pytest
from support.importing import run
import yaml

POSITIONS = np.array([[0.4, 0.3, 0.0], [0.4, -0.3, 0.0], [-0.2, 0.3, 0.1], [-0.2, -0.3, 0.1],
                      [-0.4, 0.0, 0.2]])
DIRECTIONS = np.array([[1, 0, 0], [1, 0, 0], [0, 0, 1], [0, 0, 1], [0, 1, 0]], dtype=float)
B = np.vstack([DIRECTIONS.T, np.cross(POSITIONS, DIRECTIONS).T])
NAMES = ['left', 'right', 'up_left', 'up_right', 'side']


@pytest.fixture
def compared(tmp_path, capsys):
    """Return a function that compares two matrices: status, and the lines that disagree."""
    def compare(one, other, names=NAMES, others=NAMES, **beside):
        files = []
        for stem, matrix, known, more in (('one', one, names, {}),
                                          ('other', other, others, beside)):
            files.append(tmp_path / f'{stem}.yaml')
            files[-1].write_text(yaml.safe_dump(
                {'tam': np.asarray(matrix).tolist(), 'thrusters': known, **more}))
        status = run(files[0], '--frame', 'flu', '--against', files[1])
        lines = capsys.readouterr().out.splitlines()
        assert lines[-1] == ('They disagree.' if status else 'They agree.')
        return status, [line.removeprefix('! ') for line in lines if line.startswith('!')]
    return compare


def scaled(*factors):
    """Return B with its rows scaled."""
    return np.array(factors)[:, None] * B


def test_the_same_vehicle_agrees(compared):
    """Rounding, spelling and the order of named thrusters make no difference."""
    assert compared(B, np.round(B, 3)) == (0, [])
    assert compared(B, B, others=['Left', 'right_', 'up-left', 'UP_RIGHT', 'side']) == (0, [])
    order = [4, 2, 0, 1, 3]
    assert compared(B, B[:, order], others=[NAMES[i] for i in order]) == (0, [])


def test_a_row_of_the_other_sign(compared):
    """It is said of the DOF, and of each thruster with its numbers."""
    status, lines = compared(B, scaled(1, 1, 1, -1, 1, 1))
    assert status == 1 and lines[0] == 'roll: the other sign throughout'
    assert 'up_left: roll +0.300 against -0.300 m' in lines and len(lines) == 4


def test_arms_that_differ_by_a_share(compared):
    """A common factor is said in percent."""
    status, lines = compared(scaled(1, 1, 1, 1, 1, 1.13), B)
    assert status == 1 and lines[0] == 'yaw: arms 13 % longer in one.yaml'
    status, lines = compared(B, scaled(1, 1, 1, 1, 1, -1.13))
    assert lines[0] == 'yaw: the other sign throughout, and arms 12 % shorter in one.yaml'


def test_a_thruster_that_pushes_the_other_way(compared):
    """It is said once, and not again of every DOF."""
    assert compared(B, B * [1, 1, 1, -1, 1]) == (
        1, ['up_right: positive thrust pushes the other way'])


def test_one_arm_that_differs(compared):
    """The DOF says at which thruster, the thruster how much."""
    other = B.copy()
    other[5, 0] *= 2.0
    assert compared(B, other) == (1, ['yaw: differs at left',
                                      'left: yaw -0.300 against -0.600 m'])


def test_directions_apart(compared):
    """The angle between them is told."""
    other = B.copy()
    other[:3, 0] = [np.cos(0.2), np.sin(0.2), 0.0]
    status, lines = compared(B, other)
    assert status == 1 and 'left: directions 11.5 degrees apart' in lines


def test_a_dof_that_only_one_serves(compared):
    """The file that has nothing for it is named."""
    _, lines = compared(scaled(1, 1, 1, 0, 1, 1), B)
    assert lines[0] == 'roll: thrusters act on it in other.yaml, none in one.yaml'


def test_what_explains_everything_is_said_alone(compared):
    """Axes turned over, or the same thrusters in another order, are one line, not twelve."""
    _, lines = compared(B, scaled(1, -1, -1, 1, -1, -1))
    assert len(lines) == 1 and 'one of the two is in flu axes, the other in frd' in lines[0]
    _, lines = compared(B, B[:, [1, 0, 2, 3, 4]], others=[f't{i}' for i in range(5)])
    assert lines == ['the thrusters come in another order: left is t1, right is t0, '
                     'up_left is t2, up_right is t3, side is t4']


def test_different_thrusters(compared):
    """Another number of them, and other limits where both files have some, are told."""
    assert compared(B, B[:, :4], others=NAMES[:4]) == (
        1, ['5 thrusters in one.yaml, 4 in other.yaml'])
    assert compared(B, B[:, :4], others=list('abcd')) == (
        1, ['5 thrusters in one.yaml, 4 in other.yaml'])


def test_limits(tmp_path, capsys):
    """Limits count where both files give them."""
    files = []
    for stem, limit in (('one', 40.0), ('other', 50.0), ('none', None)):
        files.append(tmp_path / f'{stem}.yaml')
        entry = {'position': [0.0, 0.0, 0.0], 'direction': [1.0, 0.0, 0.0]}
        files[-1].write_text(yaml.safe_dump({'thrusters': {'t': {
            **entry, **({'limits': [-limit, limit]} if limit else {})}}}))
    assert run(files[0], '--frame', 'frd', '--against', files[1]) == 1
    assert '! t: limits [-40, 40] against [-50, 50] N' in capsys.readouterr().out
    assert run(files[0], '--frame', 'frd', '--against', files[2]) == 0


def test_a_parameter_file_against_its_source(tmp_path, mt2012, capsys):
    """What was imported agrees with what it was imported from, and MT-2012 with itself."""
    source, output = tmp_path / 'source.yaml', tmp_path / 'mine.yaml'
    source.write_text(yaml.safe_dump({'tam': B.tolist(), 'thrusters': NAMES}))
    assert run(source, '--frame', 'flu', '--output', output, '--against', output) == 1
    assert 'mine.yaml: cannot be read' in capsys.readouterr().err
    assert run(source, '--frame', 'flu', '--output', output) == 0
    assert run(output, '--against', source, '--frame', 'flu') == 0
    assert run(mt2012, '--against', mt2012) == 0
