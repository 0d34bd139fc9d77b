"""The parameter file that an import writes: it starts the node, and says what it does not know."""

import re
import signal
import threading

from hypothesis import given, strategies as st
import numpy as np
import pytest
from support.importing import run, sdf, sdf_thruster
from support.paths import ROOT
from support.processes import NODE, TIMEOUT
from thrust_allocator.import_vehicle.parameter_file import legal_names
from thrust_allocator.parameters.guesses import marked_guesses
import yaml

FOUR = ''.join(sdf_thruster(f'auv/thruster {i}', f'{x} {y} 0 0 0 {yaw}', plugin=limits)
               for i, (x, y, yaw, limits) in enumerate((
                   (0.3, 0.2, 0.0, ''), (0.3, -0.2, 0.0, '<max_thrust_cmd>50</max_thrust_cmd>'
                                         '<min_thrust_cmd>-30</min_thrust_cmd>'),
                   (-0.3, 0.2, 1.57, ''), (-0.3, -0.2, 1.57, ''))))


@pytest.fixture
def written(tmp_path):
    """Return the file of a vehicle of four thrusters, three of them without limits."""
    (tmp_path / 'auv.sdf').write_text(sdf(FOUR))
    assert run(tmp_path / 'auv.sdf', '--output', tmp_path / 'new' / 'my_vehicle.yaml') == 0
    return tmp_path / 'new' / 'my_vehicle.yaml'


def test_it_starts_the_node(written, start):
    """The node takes every value, and has the thrusters of the source."""
    node, _ = start(file=written)
    assert [one.name for one in node.vehicle.thrusters] == [
        f'auv_thruster_{i}_joint' for i in range(4)]
    assert np.allclose(node.vehicle.configuration_matrix[0], [1, 1, 0, 0], atol=1e-3)


def test_the_start_repeats_the_guesses(written, launch):
    """The process warns of each guess by its parameter's name, and runs."""
    process = launch(*NODE, '--ros-args', '--params-file', written)
    watchdog = threading.Timer(TIMEOUT, process.kill)
    watchdog.start()
    try:
        line = next(line for line in process.stderr if 'guess' in line)
        process.send_signal(signal.SIGINT)
        process.communicate()
    finally:
        watchdog.cancel()
    assert process.returncode == 0
    assert re.findall(r'thrusters\.auv_thruster_(\d)_joint\.bollard_thrust', line) == list('023')


def test_guesses_are_marked_where_they_stand(written):
    """Whoever deletes the mark deletes the warning; a comment elsewhere is none."""
    names = marked_guesses(written)
    assert names == [f'thrusters.auv_thruster_{i}_joint.bollard_thrust' for i in (0, 2, 3)]
    text = written.read_text()
    written.write_text(text.replace(', GUESS: the source has no limits', '', 1))
    assert marked_guesses(written) == names[1:]
    written.write_text(text.replace('GUESS: ', ''))
    assert marked_guesses(written) == []
    written.write_text('n:\n  ros__parameters:\n    # no GUESS\n    rate: 20.0 # Hz, a GUESS\n'
                       '    a:\n      b: [1.0,\n          2.0]  # GUESS\n    c: 1.0  # GUESSED\n')
    assert marked_guesses(written) == ['rate', 'a.b']


def test_what_the_files_of_the_package_mark(mt2012):
    """None of the vehicles in config/ has values that are nothing but guesses."""
    assert not any(map(marked_guesses, mt2012.parent.glob('*.yaml')))


def test_its_comments(written):
    """Names of the source, axes, origin, and which document tells how to get what is missing."""
    text = written.read_text()
    assert '# "auv/thruster 1_joint" in the source' in text
    head = ' '.join(text.split('/**:')[0].replace('#', ' ').split())
    assert 'x forward, y left, z up' in head and 'the frame of model auv' in head
    assert 'Limits of 3 of 4 thrusters' in head
    documents = set(re.findall(r'doc/\w+\.md', head))
    assert documents and all((ROOT / document).is_file() for document in documents)
    assert max(map(len, text.splitlines())) <= 110


@given(st.lists(st.text(min_size=0, max_size=8), min_size=1, max_size=5))
def test_names_are_legal_and_different(names):
    """Whatever the source calls them, ROS and YAML take each name for a word of its own."""
    legal = legal_names(names)
    assert len(set(legal)) == len(names)
    assert all(re.fullmatch('[A-Za-z][A-Za-z0-9_]*', name) for name in legal)
    assert yaml.safe_load(f'[{", ".join(legal)}]') == legal


def test_names_that_rcl_would_take_for_something_else():
    """Booleans and numbers are given a word in front."""
    assert legal_names(['y', 'off', '0', 'nan', 't', 't', 'a b']) == [
        'thruster_y', 'thruster_off', 'thruster_0', 'thruster_nan', 't', 't_2', 'a_b']
