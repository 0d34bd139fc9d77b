"""How the process ends by crashes and a lost context, as another process hears it."""

import pytest


@pytest.mark.parametrize('place', [
    'allocation.AllocationProblem, "solve"', 'bounds.ThrustBounds, "in_flow"',
    'inputs.Inputs, "accept_wrench"', 'node.ThrustAllocator, "_begin_report"',
    'node.ThrustAllocator, "_send"'])
def test_an_exception_in_a_callback(breaking, place):
    """After an exception, wherever it comes from, zeros come last and the status is not 0."""
    status, stderr = breaking(f'patch({place}, fail)').end()
    assert status == 1
    assert 'Traceback' in stderr
    assert stderr.rstrip().endswith('ArithmeticError: broken on purpose')


@pytest.mark.parametrize('change', [
    'threading.Thread(target=lambda: broken.wait() and rclpy.shutdown(), daemon=True).start()',
    'patch(inputs.Inputs, "accept_wrench", lambda *_: rclpy.try_shutdown())',
    'patch(allocation.AllocationProblem, "solve",'
    ' lambda original, *arguments: (rclpy.try_shutdown(), original(*arguments))[1])',
    'patch(node.ThrustAllocator, "_begin_report",'
    ' lambda original, *arguments: (rclpy.try_shutdown(), original(*arguments))[1])',
], ids=['in a thread', 'between ticks', 'in a tick', 'in a report'])
def test_a_context_shut_down_from_outside(breaking, change):
    """Without a context no zeros can go out: one line says so and the exit status is 1."""
    status, stderr = breaking(change).end(zeros=False)
    said = [line for line in stderr.splitlines() if not line.startswith(('[WARN]', '[INFO]'))]
    assert status == 1
    assert said == ['thrust_allocator: the ROS context was shut down from outside: '
                    'the last setpoints stand'], stderr
