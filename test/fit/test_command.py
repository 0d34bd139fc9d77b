"""What the command writes and says, for tables as people have them."""

from dataclasses import replace
import math

import pytest
from support.paths import MT2012
from support.tow import COSINE, PAPER, QUADRATIC, tow, TUNNEL, written
from thrust_allocator.fit.__main__ import main
from thrust_allocator.parameters.build import describe
from thrust_allocator.parameters.file import read_parameter_file
import yaml

PLACE = {'position': [0.0, 0.0, 0.0], 'direction': [1.0, 0.0, 0.0]}


# Few rows, so that leaving out runs takes no time
FEW = {'angles': (0.0, 45.0, 180.0), 'commands': (1.0,)}


@pytest.fixture
def without_pictures(monkeypatch):
    """Hide matplotlib: pictures take most of the time."""
    monkeypatch.setattr('thrust_allocator.fit.__main__.find_spec', lambda name: None)


@pytest.fixture
def fit(tmp_path, capsys):
    """Return a function that fits a table and returns the thruster's model and what was said."""
    def run(table, *options):
        status = main(['fit', str(table), '--thruster', 'one', '--output', str(tmp_path / 'out'),
                       *options])
        out, err = capsys.readouterr()
        assert status == 0, err
        assert out == (tmp_path / 'out/fit.yaml').read_text('utf-8')
        values = yaml.safe_load(out)['thrusters']['one'] | PLACE
        given = {f'thrusters.one.{name}': value for name, value in values.items()}
        vehicle = describe({'thruster_names': ['one'], **given}).vehicle
        return vehicle.thrusters[0].model, err, (tmp_path / 'out/report.md').read_text('utf-8')
    return run


def test_a_table_in_newtons(fit, tmp_path):
    """The snippet is a thruster that the node takes, with the coefficients of the table."""
    model, err, report = fit(written(tow(COSINE, **FEW), tmp_path / 'tow.csv'))
    assert model.angle_law == 'cosine'
    assert model.bollard_thrust == pytest.approx(COSINE.bollard_thrust, rel=1e-3)
    assert model.speed_loss == pytest.approx(COSINE.speed_loss, rel=1e-3)
    assert model.opposed_loss == pytest.approx(COSINE.opposed_loss, rel=1e-3)
    assert model.speed_loss_quadratic == (0.0, 0.0)
    assert 'of runs that were left out' in report and 'Fastest run: 1.5 m/s' in report
    assert {file.name for file in (tmp_path / 'out').iterdir()} == {
        'fit.yaml', 'report.md', 'fit.png', 'fit.svg'}


def test_a_spreadsheet_with_kgf_and_decimal_commas(fit, tmp_path, without_pictures):
    """Semicolons, commas for points, a mark of byte order, capitals, a remark, empty lines."""
    rows = ['Command;Speed;Angle;Thrust_kgf;Remark']
    rows += [f'{row.command};{row.speed};{math.degrees(row.angle):.2f};{row.thrust / 9.80665:.4f};'
             'tank 2'.replace('.', ',') for row in tow(QUADRATIC, **FEW)]
    text = '\ufeff' + '\r\n'.join(rows[:1] + [row.replace('.', ',') for row in rows[1:]])
    (tmp_path / 'tow.csv').write_text(text + '\r\n;;;;\r\n', encoding='utf-8')
    model, err, _ = fit(tmp_path / 'tow.csv', '--quadratic')
    assert model.speed_loss == pytest.approx(QUADRATIC.speed_loss, rel=0.01)
    assert model.speed_loss_quadratic == pytest.approx(QUADRATIC.speed_loss_quadratic, rel=0.02)
    assert 'columns that are not used: remark' in err


def test_pwm_with_a_dead_band(fit, tmp_path, without_pictures):
    """Counted from neutral, where nothing turns up to 1525 and down to 1475."""
    rows = [replace(row, command=1500.0 + math.copysign(25.0, row.command) + 0.2 * row.command)
            for row in tow(COSINE, **FEW)]
    rows += [replace(rows[0], command=command, speed=0.0, thrust=0.0, run='')
             for command in (1475.0, 1500.0, 1525.0)]
    model, err, _ = fit(written(rows, tmp_path / 'pwm.csv'), '--neutral', '1500')
    assert model.speed_loss == pytest.approx(COSINE.speed_loss, rel=0.02)
    assert model.bollard_thrust == pytest.approx(COSINE.bollard_thrust, rel=0.01)
    assert '1 rows at the neutral command are not used' in err


def test_the_papers_law_and_a_top_speed(fit, tmp_path, without_pictures):
    """The angle parameter comes too; beyond the fastest run there is a WARN."""
    table = written(tow(PAPER, commands=(1.0,)), tmp_path / 'tow.csv')
    model, err, _ = fit(table, '--law', 'paper', '--top-speed', '2')
    assert model.critical_angle_slope == pytest.approx(0.25, rel=0.01)
    assert 'WARN: the vehicle does 2 m/s, the fastest run is 1.5 m/s' in err


@pytest.mark.parametrize('options, angles, left_alone', [
    (['--law', 'paper'], (0.0, 180.0), 'critical_angle_slope keeps its default: all runs are alo'),
    (['--law', 'paper'], (30.0,), 'critical_angle_slope keeps its default: all runs are at one'),
    ([], (0.0, 45.0), 'opposed_loss forward keeps its default 0: no flow against its jet')])
def test_what_the_rows_cannot_tell_is_left_alone(fit, tmp_path, without_pictures, options, angles,
                                                 left_alone):
    """It keeps its default, is not in the snippet, and the report says why."""
    table = written(tow(COSINE, angles=angles, commands=(1.0,)), tmp_path / 'tow.csv')
    model, _, report = fit(table, *options)
    assert left_alone in report
    assert model.critical_angle_slope == 0.2
    assert 180.0 in angles or model.opposed_loss == (0.0, 0.0)


def test_a_sense_that_was_not_towed_is_a_guess(fit, tmp_path, without_pictures):
    """Its C is scaled, and marked so that the node warns of it at each start."""
    rows = [row for row in tow(COSINE, **FEW) if row.command > 0.0 or row.speed == 0.0]
    model, _, report = fit(written(rows, tmp_path / 'tow.csv'))
    assert model.speed_loss[0] == pytest.approx(15.6 * 40.0 / 51.0, rel=1e-3)
    assert 'GUESS: reverse is scaled' in report


def test_a_tunnel(fit, tmp_path, without_pictures):
    """Area times decay is the product that made the table, whichever area is given."""
    table = written(tow(TUNNEL, angles=(90.0,), commands=(1.0,)), tmp_path / 'tow.csv')
    for area in ('0.00385', '0.1'):
        model, _, _ = fit(table, '--model', 'tunnel', '--area', area, '--water-density', '1025')
        assert model.decay * model.jet_mass == pytest.approx(1.76 * 7.7, rel=1e-3)


@pytest.mark.parametrize('quadratic', [[], ['--quadratic']], ids=['straight', 'quadratic'])
def test_safe_is_optimistic_nowhere(fit, tmp_path, without_pictures, quadratic):
    """No row of a table with a curved loss comes out above its sigma, and some touches it."""
    rows = [replace(row, sigma=0.3) for row in tow(QUADRATIC, 0.01, 5, **FEW)]
    table = tmp_path / 'tow.csv'
    table.write_text('command,speed,angle,thrust,sigma\n' + ''.join(
        f'{row.command},{row.speed},{math.degrees(row.angle)},{row.thrust},{row.sigma}\n'
        for row in rows), encoding='utf-8')
    model, _, report = fit(table, '--safe', *quadratic)
    at_rest = {row.command: row.thrust for row in rows if row.speed == 0.0}
    full = {max(at_rest): model.bollard_thrust[1], min(at_rest): model.bollard_thrust[0]}
    over = []
    for row in rows:
        told = full.get(row.command, at_rest[row.command])
        thrust = model.thrust_in_flow(told, row.speed * math.cos(row.angle),
                                      row.speed * math.sin(row.angle))
        over.append((thrust - row.thrust) * math.copysign(1.0, row.command))
    assert 0.25 < max(over) <= 0.3 + 1e-3
    assert 'the most optimistic row is +0.3 N off' in report


def test_what_is_odd_is_said(fit, tmp_path, without_pictures):
    """Coefficients that go together, one speed alone, and no row to spare for an interval."""
    table = written(tow(QUADRATIC, 0.01, 2, **FEW), tmp_path / 'tow.csv')
    _, err, report = fit(table, '--quadratic')
    assert 'speed_loss_quadratic forward go together' in err
    few = [row for row in tow(COSINE, sides=(1,), speeds=(1.0,), angles=(0.0,), commands=(1.0,))]
    _, err, report = fit(written(few, tmp_path / 'tow.csv'))
    assert 'all runs are at 1 m/s' in err
    assert 'No interval: the table has no row to spare' in report
    assert 'could not be left out' in report


def test_angles_counted_from_the_wrong_sense_are_found(fit, tmp_path, without_pictures):
    """Astern under reverse thrust is 180 degrees; written as 0 the law cannot describe it."""
    rows = [replace(row, angle=0.0) for row in tow(COSINE, angles=(0.0,))]
    _, err, report = fit(written(rows, tmp_path / 'tow.csv'))
    assert 'bollard_thrust reverse comes out as' in err and 'are angles and speeds right?' in err
    assert 'astern under reverse thrust is 180' in report
    _, err, _ = fit(written(tow(COSINE, 0.01, angles=(0.0,)), tmp_path / 'tow.csv'))
    assert 'describe' not in err


def test_without_matplotlib(fit, tmp_path, without_pictures):
    """Everything but the picture, and a line that says so."""
    _, err, _ = fit(written(tow(COSINE, speeds=(1.0,), **FEW), tmp_path / 'tow.csv'))
    assert "no picture, which needs matplotlib: pip install '.[plot]'" in err
    assert {file.name for file in (tmp_path / 'out').iterdir()} == {'fit.yaml', 'report.md'}


def test_the_snippet_fits_into_a_vehicle(fit, tmp_path, without_pictures):
    """Put in the place of one of MT-2012's thrusters it makes a sound vehicle."""
    fit(written(tow(PAPER, 0.01, commands=(1.0,)), tmp_path / 'tow.csv'), '--law', 'paper')
    values = yaml.safe_load((tmp_path / 'out/fit.yaml').read_text())['thrusters']['one']
    given = read_parameter_file(MT2012)
    given |= {f'thrusters.up.{name}': value for name, value in values.items()}
    assert describe(given).warnings == []
