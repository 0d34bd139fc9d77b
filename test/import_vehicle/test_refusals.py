"""What cannot be imported is refused in one line that says why, and what to do."""

from support.importing import gz_thruster, run, sdf, sdf_thruster, urdf, urdf_joint
import pytest
import yaml

EYE = [[float(i == j) for j in range(6)] for i in range(6)]
ONE = [[1.0], [0.0], [0.0], [0.0], [0.0], [0.0]]


def column(*values):
    """Return a matrix of one column."""
    return yaml.safe_dump({'tam': [[value] for value in values]})


SERVO = urdf_joint('servo', 'base_link', 'arm', kind='revolute') + urdf_joint(
    't', 'arm', 'prop', kind='continuous') + gz_thruster('t')
MOVING = sdf('<link name="arm"/><joint name="servo" type="revolute"><parent>base_link</parent>'
             '<child>arm</child></joint>' + sdf_thruster('t', '0 0 0 0 0 0', parent='arm'))


@pytest.mark.parametrize('text, words', [
    (urdf(SERVO), ['thruster t hangs on joint servo, which moves (revolute)']),
    (MOVING, ['thruster t_joint hangs on joint servo, which moves (revolute)']),
    ('<robot xmlns:xacro="x"><xacro:include filename="a"/></robot>', ['xacro', 'source.urdf']),
    (urdf('<link name="${prefix}a"/>'), ['is xacro (line 2: ${prefix})', 'xacro ']),
    (sdf('<pose>@x 0 0 0 0 0</pose>'), ['placeholders (line 2: @x)', "sed 's/@x/VALUE/'"]),
    (sdf('<pose>@(x) 0 0 0 0 0</pose>'), ['EmPy', 'empy3']),
    (sdf('<pose>{{ x }} 0 0 0 0 0</pose>'), ['Jinja', 'jinja2']),
    ('tam: {{ matrix }}', ['Jinja', 'jinja2', 'source.yaml']),
    ('# of @somebody\ntam: [@a, @b]', ['placeholders (line 2: @a)']),
    ('<% n = 4 %>' + sdf(''), ['ERB', 'erb ']),
    (sdf('<plugin filename="hydro" name="h"/>'), ['no thruster plugin', 'hydro']),
    (sdf(gz_thruster('gone')), ['the joint gone of a thruster plugin is not in the file',
                                'gz sdf -p']),
    ('<sdf version="1.9"><include/></sdf>', ['has no model', 'gz sdf -p']),
    ('<launch/>', ['root <launch>', 'URDF', 'SDF']),
    ('<robot><link>', ['is no XML']),
    (sdf(sdf_thruster('t', '0 0 0 0 0 0', axis='0 0 0')), ['axis of joint t_joint is 0']),
    (sdf(sdf_thruster('t', '0 0 0 0 0')), ["the pose of t: is '0 0 0 0 0', must be 6 numbers"]),
    (sdf(sdf_thruster('t', '0 0 0 0 0 0', pose_attributes='relative_to="t"')),
     ['the pose of t is relative to itself']),
    (sdf(sdf_thruster('t', '0 0 0 0 0 0', pose_attributes='relative_to="gone"')),
     ['the frame gone is not in the file']),
    (sdf('<link name="other"/>' + sdf_thruster('t', '0 0 0 0 0 0')
         + sdf_thruster('u', '0 0 0 0 0 0', parent='other')),
     ['no fixed joint connects: t_joint on base_link, u_joint on other']),
    ('', ['holds no keys']),
    ('just words', ['holds no keys']),
    ('a: [1, 2', ['is no YAML']),
    ('tam: &a [*a]', ['tam: has 1 rows']),
    ('tam: &a {b: *a}', ['is nested too deeply']),
    (sdf('', 'new'), ['no thruster plugin']),
    ('rate: 50', ['neither an allocation matrix', 'nor a layout'])])
def test_one_line_each(refused, text, words):
    """One line that names the thing, its place and the way out."""
    line = refused(text)
    assert all(word in line for word in words), line


@pytest.mark.parametrize('text, words', [
    (column(1.2, 0, 0, 0, 0, 0), ['thruster_0', 'norm 1.2', 'newtons']),
    (column(0.985, 0, 0, 0, 0, 0), ['norm 0.985']),
    (column(0, 0, 0, 0, 0, 0.3), ['thruster_0', 'pure moment']),
    (column(0, 0, 0, 0, 0, 0), ['all 0']),
    (column(1, 0, 0, 0.4, 0, 0), ['0.4 N*m per newton along its own axis']),
    (yaml.safe_dump({'tam': EYE[:5]}), ['tam: has 5 rows', 'transpose it', '6 x n']),
    (yaml.safe_dump({'tam': [*ONE[:5], [1.0, 2.0]]}), ['tam: its rows are not of the same length']),
    (yaml.safe_dump({'tam': [1.0] * 7}), ['tam: has 7 entries']),
    (yaml.safe_dump({'tam': ONE, 'b': {'tam': ONE}}),
     ['more than once: matrix tam, matrix b.tam']),
    (yaml.safe_dump({'position': [[1.0], [0.0], [0.0]], 'direction': [[1.0], [1.0], [0.0]]}),
     ['norm 1.414']),
    (yaml.safe_dump({'position': [[1.0], [0.0], [0.0]], 'direction': [[1.0, 0.0]] * 3}),
     ['direction: is of 2 thrusters, but position of 1'])])
def test_matrices_and_layouts(refused, text, words):
    """What is no newton and no thruster is refused by name, with its number."""
    line = refused(text, '--frame', 'flu')
    assert all(word in line for word in words), line


def test_axes_must_be_known(refused):
    """Neither guessed nor overruled."""
    assert '--frame flu (x forward, y left, z up) or --frame frd' in refused(column(1, *[0] * 5))
    assert 'is in flu axes, must not be given --frame frd' in refused(
        sdf(sdf_thruster('t', '0 0 0 0 0 0')), '--frame', 'frd')


def test_files_that_are_not_there(tmp_path, mt2012, capsys):
    """A missing file, a folder, and a parameter file, which is there already."""
    for source, words in ((tmp_path / 'none.sdf', 'cannot be read: No such file'),
                          (tmp_path, 'cannot be read: Is a directory'),
                          (mt2012, 'is a parameter file already')):
        assert run(source, '--output', tmp_path / 'out.yaml') == 1
        error = capsys.readouterr().err
        assert words in error and error.count('\n') == 1
    binary = tmp_path / 'mesh.stl'
    binary.write_bytes(b'\xff\xfe\x00\x80')
    assert run(binary, '--output', tmp_path / 'out.yaml') == 1
    assert 'is no text' in capsys.readouterr().err


@pytest.mark.parametrize('args, words', [
    ((), 'required: --output, or --against'), (('--origin', '1,2'), "'1,2' must be X,Y,Z"),
    (('--frame', 'ned'), "invalid choice: 'ned'"), (('--colour', 'red'), 'unrecognized')])
def test_a_mistake_on_the_command_line(args, words, capsys):
    """One line and status 2."""
    with pytest.raises(SystemExit) as caught:
        run('file', *args)
    error = capsys.readouterr().err
    assert caught.value.code == 2 and words in error and error.count('\n') == 1


def test_the_source_is_not_overwritten(tmp_path, capsys):
    """The file that is imported stays."""
    source = tmp_path / 'auv.sdf'
    source.write_text(sdf(sdf_thruster('t', '0 0 0 0 0 0')))
    before = source.read_bytes()
    assert run(source, '--output', source) == 1
    assert source.read_bytes() == before and 'must be another' in capsys.readouterr().err
