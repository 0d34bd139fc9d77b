"""How the node is started: what its process takes, refuses, and never mistakes for MT-2012."""

import os
import signal
import threading

import pytest
import rclpy
from support.paths import CONFIG
from thrust_allocator.ros import process

HEAD = '/**:\n  ros__parameters:\n    '
VEHICLE = """thruster_names: [FL]
    thrusters: {FL: {model: constant, position: [0.0, 0.0, 0.0], direction: [1.0, 0.0, 0.0],
                     bollard_thrust: [-10.0, 20.0]}}
"""


@pytest.fixture
def start(monkeypatch, capfd):
    """Return a function that runs the process's main to its first turn: status, node, stderr."""
    started = []

    class OneTurn:
        def add_node(self, node):
            node.stop = lambda: None
            started.append(node)

        def spin_once(self):
            os.kill(os.getpid(), signal.SIGINT)

    handlers = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    monkeypatch.setattr(process, 'SingleThreadedExecutor', OneTurn)

    def run(*arguments):
        started.clear()
        status = process.main(['node', *map(str, arguments)])
        out, err = capfd.readouterr()
        return status, started[0] if started else None, out, err

    yield run
    rclpy.try_shutdown()
    for number, handler in handlers.items():
        signal.signal(number, handler)


@pytest.fixture
def refusal(start):
    """Return a function that gives the one line with which a start is refused."""
    def refused(*arguments):
        status, node, out, err = start(*arguments)
        assert (status, node, out, err.count('\n')) == (1, None, '', 1), (status, node, out, err)
        return err.removeprefix('thrust_allocator: ').rstrip('\n')
    return refused


@pytest.fixture
def write(tmp_path):
    """Return a function that writes a parameter file and returns its path."""
    def write(content, name='my_vehicle.yaml'):
        (tmp_path / name).write_text(content, encoding='utf-8')
        return tmp_path / name
    return write


@pytest.mark.parametrize('arguments', [
    (), ('--ros-args',), ('--ros-args', '-p', 'rate:=20.0'), ('--ros-args', '-r', '__ns:=/a'),
    ('--ros-args', '-r', '__ns:=/' + 'a' * 203),
    ('--ros-args', '-r', 'cmd_wrench:=/w', '--'), ('--ros-args', '--enable-rosout-logs')])
def test_mt2012_runs_if_nothing_else_is_asked_for(start, arguments):
    """Without an argument of the node's own, and with -p and -r alone, and one WARN says so."""
    status, node, out, err = start(*arguments)
    assert (status, len(node.vehicle.thrusters), out) == (0, 5, '')
    assert [line for line in err.splitlines() if 'running MT-2012' in line and '[WARN]' in line]


@pytest.mark.parametrize('arguments, said', [
    (['my_vehicle.yaml'], 'my_vehicle.yaml: means nothing here, must be --ros-args --params-file '
                          'my_vehicle.yaml'),
    (['__params:=x.yaml'], 'must be --ros-args --params-file x.yaml'),
    (['__ns:=/a'], 'must be --ros-args -r __ns:=/a'),
    (['rate:=20'], 'must be --ros-args -p rate:=20 for a parameter'),
    (['--params-file', 'x.yaml'], 'must be --ros-args --params-file x.yaml'),
    (['-p', 'rate:=20'], 'must be --ros-args -p rate:=20'),
    (['-r', '__ns:=/a'], 'must be --ros-args -r __ns:=/a'),
    (['--param-file', 'x.yaml'], '--param-file: means nothing here; did you mean --params-file?'),
    (['--ros-arg', '-p', 'rate:=20'], 'did you mean --ros-args?'),
    (['something'], 'something: means nothing here'), ([''], 'means nothing here'),
    (['--ros-args', '-p', 'rate:=20.0', '--', 'x.yaml'], 'x.yaml: means nothing here'),
    (['--ros-args', '--param-file', 'x.yaml'], '--param-file: is no option of ROS 2; did you mean '
                                               '--params-file?'),
    (['--ros-args', '--params-file=x.yaml'], 'must be --params-file and its value as a word of its '
                                             'own'),
    (['--ros-args', 'x.yaml'], 'must be --params-file x.yaml'),
    (['--ros-args', '--params-file'], '--params-file: stands last'),
    (['--ros-args', '-p', 'params_file:=x.yaml'], 'params_file: is no parameter here; a file is '
                                                  'read by --params-file x.yaml'),
    (['--ros-args', '-p', 'rate'], '-p rate: is no rule, must be -p NAME:=VALUE'),
    (['--ros-args', '-p', 'rate:='], 'rate: has no value'),
    (['--ros-args', '-p', 'kp:=1.0'], 'kp: is no parameter here'),
    (['--ros-args', '-p', 'start_enable:=false'], 'did you mean start_enabled?'),
    (['--ros-args', '-p', 'fallback_velocity:=[0, 0.5, 0]'], 'fallback_velocity: is [0, 0.5, 0], '
                                                             'mixes whole and real'),
    (['--ros-args', '-p', 'rate:=[]'], 'rate: is [], must be a number'),
    (['--ros-args', '-p', 'rate:={a: 1}'], "rate: is '{a: 1}', must be a value"),
    (['--ros-args', '-p', 'use_sim_time:=5'], 'use_sim_time'),
    (['--ros-args', '--params-file', '/nowhere.yaml'], '/nowhere.yaml: cannot be read: No such'),
    (['--ros-args', '--params-file', '/tmp'], '/tmp: cannot be read: Is a directory'),
    (['--ros-args', '--log-level', 'loud'], "log level"),
    (['--ros-args', '-r', '__ns:=/' + 'a' * 300], '__ns: has 301 characters, must be a namespace '
                                                  'of at most 204'),
    (['--ros-args', '-r', '__ns:=/' + 'a' * 204], '__ns: has 205 characters'),
    (['--ros-args', '-r', '__node:=' + 'a' * 300], 'node name length should not exceed'),
    (['--ros-args', '-r', '__node:=' + 'a' * 240], 'Invalid service name'),
    (['--ros-args', '-r', '__node:=1a'], '__node:=1a'),
    (['--ros-args', '-r', 'cmd_wrench:=' + 'a' * 300], 'length'),
    (['--ros-args', '-r', 'cmd_wrench:=thruster_setpoints'], 'cmd_wrench and thruster_setpoints: '
     'are both /thruster_setpoints after remapping, must be two topics'),
    (['--ros-args', '-r', 'cmd_wrench:=achieved_wrench'], 'cmd_wrench and achieved_wrench: are'),
    (['--ros-args', '-r', 'thruster_setpoints:=thrust_limits'], 'thrust_limits and '
                                                                'thruster_setpoints: are both'),
    (['--ros-args', '-r', 'odom:=current'], 'odom and current: are both /current'),
    (['--ros-args', '--params-file', '\udcff.yaml'], 'is no UTF-8'),
    (['\udcff'], 'is no UTF-8'), (['--ros-args', '-p', 'marker_frame:=\udcff'], 'is no UTF-8'),
], ids=lambda value: ascii(' '.join(value))[:60] if isinstance(value, list) else '')
def test_a_slip_on_the_command_line(refusal, arguments, said):
    """Anything that ROS does not take is refused in one line with the right form, status 1."""
    line = refusal(*arguments)
    assert said in line and len(line) < 500, line


@pytest.mark.parametrize('arguments', [
    ('--help',), ('-h',), ('--ros-args', '--help'), ('my_vehicle.yaml', '--help')][:3])
def test_help(start, arguments):
    """`--help` prints a usage that shows the right form, and the status is 0."""
    status, node, out, err = start(*arguments)
    assert (status, node, err) == (0, None, '') and out.startswith('usage: ')
    assert '--ros-args --params-file my_vehicle.yaml' in out


@pytest.mark.parametrize('more', [
    '', 'start_enabled: off', 'stamped: 2024-02-03', 'anything: ~', 'nothing: []', 'nothing: {}',
    'large: 99999999999999999999', 'op: =', 'binary: !!binary aGk=', 'mixed: [y, yes]',
    'fallback_velocity: [-.156, 0.111, 0.085]', 'rate: 1e2', 'rate: 0x14', 'rate: 20\n    rate: 30',
    'kp: 1.0', 'fallback_velocity: [0, 1, 0]', 'rate: !!float 20', 'use_sim_time: false',
    'qos_overrides: {/clock: {subscription: {depth: 1}}}'])
def test_what_ros_reads_starts(start, write, more):
    """A valid vehicle starts, however oddly its file is written or what else is in it."""
    path = write(f'{HEAD}{VEHICLE}    {more}\nother: {{ros__parameters: {{a: 2024-02-03, b: [], '
                 'c: =, d: ~, e: 99999999999999999999, f: [-.5, 0.5], g: [y, yes]}}\n')
    status, node, out, err = start('--ros-args', '--params-file', path)
    assert (status, out) == (0, ''), err
    assert [thruster.name for thruster in node.vehicle.thrusters] == ['FL']
    assert 'MT-2012' not in err


@pytest.mark.parametrize('more, said', [
    ('rate:', 'rate: has no value, must have one (line 6 of'), ('rate: ~', "rate: is '~', must be"),
    ('rate: []', 'rate: is [], must be a number'), ('rate: 2024-02-03', "rate: is '2024-02-03'"),
    ('start_enable: false', 'start_enable: is no parameter here; did you mean start_enabled?'),
    ('wrench_weight: {surge: 1.0}', 'wrench_weight.surge: is no parameter here'),
    ('fallback_velocity: [0, 0.5, 0]', 'fallback_velocity: is [0, 0.5, 0], mixes whole and real'),
    ('thrusters.FL.effectiveness: 1.5', 'thrusters.FL.effectiveness: is 1.5, must be a number'),
    ('rate: 20.0\n   x: 1', 'is not valid YAML'), ('a: &a 1\n    b: *a', 'no aliases such as *a'),
    ('a: [1, x]', 'a: is [1, x], must not mix whole numbers and words')])
def test_what_is_wrong_is_named(refusal, write, more, said):
    """One line names parameter or place."""
    assert said in refusal('--ros-args', '--params-file', write(f'{HEAD}{VEHICLE}    {more}\n'))


@pytest.mark.parametrize('names, said', [
    ('[n, e, s, w]', 'thruster_names: is [n, e, s, w], where ROS 2 takes n for false: must be '
                     "quoted, as in 'n'"),
    ('[x, y, z]', "ROS 2 takes y for true: must be quoted, as in 'y'"),
    ('[n]', "they must be quoted, as in 'n'"), ('[]', 'thruster_names: is [], must be a list'),
    ('[1, 2]', 'thruster_names: has the entry 1, must be')])
def test_names_of_thrusters_that_ros_takes_for_something_else(refusal, write, names, said):
    """Names that are booleans or nothing to ROS are explained."""
    line = refusal('--ros-args', '--params-file', write(f'{HEAD}thruster_names: {names}\n'))
    assert said in line and 'thruster_names' in line


def test_a_foreign_name_is_ours_in_a_section_that_names_us(start, refusal, write):
    """A name that a /** section may hold for others is refused under this node's own name."""
    path = write(f'{HEAD}{VEHICLE}    kp: 1.0\n    ki: 2.0\n')
    _, node, _, err = start('--ros-args', '--params-file', path)
    said, = [line for line in err.splitlines() if 'kp' in line]
    assert node and '[WARN]' in said and 'ki, kp: no parameter of this node, ignored' in said
    rclpy.try_shutdown()
    path = write(f'{HEAD}{VEHICLE}thrust_allocator: {{ros__parameters: {{kp: 1.0}}}}\n')
    assert refusal('--ros-args', '--params-file', path) == 'kp: is no parameter here'


@pytest.mark.parametrize('content', [
    '/other: {ros__parameters: {a: 1}}\n', '/other/thrust_allocator: {ros__parameters: {a: 1}}\n',
    '', '{}\n'])
def test_each_file_must_have_something_for_us(start, refusal, write, content):
    """Of several files, one that has nothing for the node is refused, whichever place it has."""
    good, bad = write(HEAD + VEHICLE), write(content, 'bad.yaml')
    for files in ((good, bad), (bad, good), (bad,)):
        line = refusal('--ros-args', *(word for file in files for word in ('--params-file', file)))
        assert line.startswith(f'{bad}: has nothing for the node /thrust_allocator; its top keys')
    more = write('/**: {ros__parameters: {use_sim_time: false}}\n', 'more.yaml')
    assert start('--ros-args', '--params-file', good, '--params-file', more)[0] == 0


def test_what_reads_otherwise_than_it_looks_is_a_warning(start, write):
    """An octal number is said with its value, and a name that stands twice with its lines."""
    path = write(f'{HEAD}{VEHICLE}    rate: 020\n    water_density: 1e3\n'
                 '    water_density: 999.0\n')
    status, node, _, err = start('--ros-args', '--params-file', path)
    assert status == 0 and node.get_parameter('rate').value == 16.0
    assert 'rate: 020 is 16 to ROS 2' in err
    assert 'water_density: stands twice, in line 7 of' in err


@pytest.mark.parametrize('rules, name, value', [
    (['fallback_velocity:=[-.5, 0.0, 0.0]'], 'fallback_velocity', [-0.5, 0.0, 0.0]),
    (['thrusters.up.enabled:=n'], 'thrusters.up.enabled', False),
    (['start_enabled:=off'], 'start_enabled', False), (['rate:=20', 'rate:=30.5'], 'rate', 30.5),
    (['rate:=1e2'], 'rate', 100.0), (['thrust_allocator:rate:=12.5'], 'rate', 12.5)])
def test_values_on_the_command_line(start, rules, name, value):
    """A value on the command line means what it means to ROS, and comes before the file's."""
    words = [word for rule in rules for word in ('-p', rule)]
    status, node, _, err = start('--ros-args', '--params-file', CONFIG / 'mt2012.yaml', *words)
    assert status == 0, err
    found = node.get_parameter(name).value
    assert (list(found) if isinstance(value, list) else found) == value


def test_a_pipe_is_read_once(start, refusal, tmp_path):
    """A file that can be read only once, such as `<(xacro ...)`, is read, or explained."""
    pipe = tmp_path / 'pipe.yaml'
    os.mkfifo(pipe)
    for content, run in ((HEAD + VEHICLE, start), (f'{HEAD}rate: [n, e]\n', refusal)):
        writer = threading.Thread(target=pipe.write_text, args=(content,))
        writer.start()
        answer = run('--ros-args', '--params-file', pipe)
        writer.join()
        if run is start:
            assert answer[0] == 0 and answer[1].vehicle.thrusters[0].name == 'FL', answer
            rclpy.try_shutdown()
        else:
            assert answer.startswith('rate: is [n, e]') and str(pipe) in answer
