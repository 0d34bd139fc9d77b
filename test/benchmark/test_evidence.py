"""The evidence page says what the command prints, and names a source for every number."""

import re

import numpy as np
import pytest
from support.paths import CONFIG, ROOT
from thrust_allocator.benchmark import evidence
from thrust_allocator.benchmark.evidence_pictures import draw
from thrust_allocator.benchmark.published import b_series, rotor_in_oblique_flow
from thrust_allocator.parameters.file import read_parameter_file

PAGE = (ROOT / 'doc/evidence.md').read_text('utf-8')


def test_what_is_measured():
    """The tables are whole: a share of 1 at rest is approached, thrust falls straight ahead."""
    rotor = rotor_in_oblique_flow()
    assert rotor.share.shape == (12 * 13,)
    assert (np.diff(rotor.share[rotor.angle == 0.0]) < 0.0).all()
    assert rotor.share[rotor.advance_ratio == 0.08] == pytest.approx(np.full(13, 0.95), abs=0.07)
    assert len(b_series()) == 5
    for one in b_series():
        assert one.advance_ratio.shape == one.thrust.shape == one.torque.shape
        assert (np.diff(one.thrust) < 0.0).all() and (np.diff(one.torque) < 0.0).all()


def test_cosine_predicts_what_it_has_not_seen():
    """Even points from odd ones: within 3 % RMS for cosine, the paper's law three times that."""
    points = evidence.oblique_points(rotor_in_oblique_flow())
    rms = {law.name: float(np.sqrt((evidence.held_out(law, points)[1]**2).mean()))
           for law in evidence.LAWS}
    assert rms['cosine'] <= 0.03 and rms['cosine with quadratic'] <= 0.03
    assert rms["the paper's law"] > 0.09 > rms["the paper's law, a* fitted too"]


@pytest.mark.parametrize('law', [evidence.LAWS[1], *evidence.LAWS[3:]], ids=lambda law: law.name)
def test_a_law_is_found_in_its_own_thrusts(law):
    """Points that a law made itself give back its coefficients, and no error."""
    points = evidence.oblique_points(rotor_in_oblique_flow())
    made = [0.3, 0.02][:len(law.fitted)]
    own = evidence.Points(points.along, points.across, evidence.limits(law, made, points))
    found, error = evidence.held_out(law, own)
    assert found == pytest.approx(made, rel=1e-4)
    assert np.abs(error).max() < 1e-5


@pytest.mark.parametrize('power, share', [(0, 0.5), (2, 0.5), (3, 0.5)])
def test_a_drive_without_a_change_of_torque_keeps_its_revolutions(power, share):
    """Where torque does not fall with the speed, holding it or the power changes nothing."""
    one = b_series()[0]._replace(advance_ratio=np.array([0.0, 1.0]), thrust=np.array([1.0, 0.0]),
                                 torque=np.array([0.1, 0.1]))
    assert evidence.held(one, 0.5, power) == pytest.approx(share)


@pytest.mark.parametrize('name', [
    'oblique_table', 'angle_table', 'straight_table', 'chord_table', 'drive_table'])
def test_the_page_shows_what_the_command_prints(name):
    """Each table stands on the page, figure by figure."""
    assert getattr(evidence, name)() in PAGE


def test_the_pictures_are_drawn(tmp_path):
    """Both of them, and the page shows both."""
    assert [path.name for path in draw(tmp_path)] == re.findall(r'\]\((\w+\.svg)\)', PAGE)
    assert all((tmp_path / name).stat().st_size > 10_000
               for name in ('evidence_oblique.svg', 'evidence_straight.svg'))


def test_every_number_of_every_vehicle_has_its_row():
    """The table names each parameter of each file in config/ that holds numbers, and no other."""
    listed = set()
    for vehicles, names in re.findall(r'^\| ([\w, ]+) \| (`.*?`) \|', PAGE, re.M):
        if vehicles == 'all' or (CONFIG / f'{vehicles.split(", ")[0]}.yaml').exists():
            files = [file.stem for file in CONFIG.glob('*.yaml')] if vehicles == 'all' \
                else vehicles.split(', ')
            listed |= {(file, name) for file in files for name in re.findall(r'`([\w.]+)`', names)}
    present = set()
    for file in CONFIG.glob('*.yaml'):
        for name, value in read_parameter_file(file).items():
            first = value[0] if isinstance(value, list) else value
            if isinstance(first, float):
                name = name.split('.', 2)[2] if name.startswith('thrusters.') else name
                present.add((file.stem, 'wrench_weights' if 'weights' in name else name))
    assert listed == present
