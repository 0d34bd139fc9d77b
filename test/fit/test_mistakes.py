"""Each mistake in a table, or in how it is to be read, is one line that names the row."""

import re

import pytest
from support.tow import COSINE, tow, TUNNEL, written
from thrust_allocator.fit.__main__ import main

REST = '2000,0,,51\n1000,0,,13\n-2000,0,,-40\n-1000,0,,-10\n'
HEAD = 'command,speed,angle,thrust\n'
RUN = '2000,1,0,35\n2000,1.5,0,28\n'


def said(tmp_path, capsys, text, *options):
    """Return the one line with which a table is refused."""
    table = tmp_path / 'tow.csv'
    table.write_bytes(text if isinstance(text, bytes) else text.encode())
    status = main(['fit', str(table), '--thruster', 't', '--output', str(tmp_path / 'out'),
                   *options])
    out, err = capsys.readouterr()
    assert (status, out, err.count('\n')) == (1, '', 1), err
    assert not (tmp_path / 'out').exists()
    return err.replace(str(table), 'tow.csv')


@pytest.mark.parametrize('text, expected', [
    ('', 'tow.csv: is empty, must have a line of column names and rows of numbers'),
    (b'\xff\xfe\x00', 'tow.csv: is no text in UTF-8, must be saved as CSV in UTF-8'),
    ('command,sped,angle,thrust\n', "has a column 'sped'; did you mean 'speed'?"),
    ('command,speed,thrust\n', "has no column 'angle'; its columns are 'command', 'speed', 'th"),
    ('command,speed,angle\n', "has no column of thrust, must have just one of 'thrust', 'thrust_"),
    ('command,speed,angle,thrust,thrust_kgf\n', "has 'thrust' and 'thrust_kgf', must have just"),
    ('command,speed,speed,angle,thrust\n', "has the column 'speed' twice"),
    (HEAD + REST + '2000,1,0\n', 'line 6: has 3 cells, must have 4, one for each column'),
    (HEAD + REST + '2000,fast,0,30\n', "line 6: speed is 'fast', must be a number in [0, 15] m/s"),
    (HEAD + REST + '2000,-1,0,30\n', "line 6: speed is '-1', must be a number in [0, 15] m/s"),
    (HEAD + REST + '2000,150,0,30\n', "line 6: speed is '150', must be a number in [0, 15] m/s"),
    (HEAD + REST + '2000,1,,30\n', "line 6: angle is '', must be a number in [-360, 360] degrees"),
    (HEAD + REST + '2000,1,0,3O\n', "line 6: thrust is '3O', must be a number"),
    (HEAD + REST + '2000,1,0,nan\n', "line 6: thrust is 'nan', must be a number"),
    ('command,speed,angle,thrust,sigma\n2000,0,0,51,0\n', "line 2: sigma is '0', must be a number"),
    (HEAD + REST + RUN + '2000,1,0.785,44\n2000,1,1.571,50\n',
     'line 9: angle is 1.571, the largest of all: must be degrees, these look like radians'),
    (HEAD + RUN, 'tow.csv: has no row at speed 0, must have a Bollard table'),
    (HEAD + REST, 'tow.csv: has rows at speed 0 alone, must have at least one in a flow'),
    (HEAD + '2000,0,,51\n' + RUN, 'line 2: commands forward have 1 row at speed 0, must have two'),
    (HEAD + REST + '500,0,,-3\n' + RUN, 'line 6: thrust at rest is -3 N at command 500, must have'),
    (HEAD + REST + '1500,0,,7\n' + RUN,
     'line 6: thrust at rest is 7 N where a smaller command gives 13 N, must grow'),
    (HEAD + REST + '2400,1,0,35\n', 'line 6: its command is beyond the largest one at speed 0'),
    (HEAD + REST + '2000,1,0,-35\n',
     'line 6: thrust in the flow is -35 N where the same command gives 51 N at rest, must be of '),
    (HEAD + REST + '2000,1,0,350\n',
     'line 6: thrust in the flow is 350 N where the same command gives 51 N at rest, must be at'),
    (HEAD + '1900,0,,51\n1700,0,,13\n1100,0,,-40\n1300,0,,-10\n1900,1,0,35\n',
     'has thrusts of both signs and commands of one, must be given --neutral'),
    (HEAD + REST + '2000,1,90,50\n', 'has no flow within 75 degrees of a sense of thrust')],
    ids=lambda value: str(value)[-25:])
def test_a_mistake_is_one_line(tmp_path, capsys, text, expected):
    """What it is, on which line, and what it must be."""
    assert expected in said(tmp_path, capsys, text)


@pytest.mark.parametrize('options, expected', [
    (['--quadratic'], '--quadratic: the table has one speed forward, must have two or more'),
    (['--model', 'tunnel'], 'has no flow across the tunnel (angle 90), must have some')])
def test_what_a_table_cannot_tell_is_refused_where_it_is_asked_for(tmp_path, capsys, options,
                                                                   expected):
    """A quadratic from one speed, and a tunnel that was only moved along its jet."""
    assert expected in said(tmp_path, capsys, HEAD + REST + '2000,1,0,35\n', *options)


@pytest.mark.parametrize('options', [
    ['--model', 'tunnel', '--law', 'paper'], ['--area', '1'], ['--top-speed', '-1'],
    ['--neutral', 'x'], ['--thruster', 'no name']])
def test_a_mistake_on_the_command_line(tmp_path, capsys, options):
    """It ends in one line and status 2."""
    with pytest.raises(SystemExit) as ended:
        main(['fit', 'tow.csv', '--thruster', 't', '--output', str(tmp_path), *options])
    assert ended.value.code == 2
    assert re.fullmatch('fit: .*\n', capsys.readouterr().err)


def test_a_wrong_neutral_is_found(tmp_path, capsys):
    """With PWM counted from elsewhere the senses contradict each other."""
    table = written(tow(COSINE), tmp_path / 'pwm.csv', neutral=1500.0, scale=0.2)
    assert 'or is --neutral wrong?' in said(tmp_path, capsys, table.read_text(),
                                            '--neutral', '1250')


def test_a_tunnel_keeps_its_word_about_the_area(tmp_path, capsys):
    """Without --area it is assumed, and both the report and the snippet say so."""
    table = written(tow(TUNNEL, angles=(90.0,), speeds=(0.5, 1.0)), tmp_path / 'tunnel.csv')
    assert main(['fit', str(table), '--thruster', 'bow', '--model', 'tunnel', '--output',
                 str(tmp_path)]) == 0
    assert 'assumed: only its product with decay counts' in capsys.readouterr().out
    assert 'assumed (--area)' in (tmp_path / 'report.md').read_text('utf-8')
