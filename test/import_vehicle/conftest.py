"""Shared by the tests of the importer."""

from support.importing import matrix, run
import pytest


@pytest.fixture
def imported(tmp_path, capsys):
    """Return a function that imports a text and returns the matrix, and the file's text."""
    def read(text, *args, name='source', frame='flu'):
        source, output = tmp_path / name, tmp_path / 'my_vehicle.yaml'
        source.write_text(text, 'utf-8')
        status = run(source, '--output', output, *args)
        assert status == 0, capsys.readouterr().err
        return matrix(output, frame), output.read_text('utf-8')
    return read


@pytest.fixture
def refused(tmp_path, capsys):
    """Return a function that imports a text and returns the one line that refuses it."""
    def read(text, *args, name='source'):
        source, output = tmp_path / name, tmp_path / 'my_vehicle.yaml'
        source.write_text(text, 'utf-8')
        assert run(source, '--output', output, *args) == 1
        said = capsys.readouterr()
        assert said.out == '' and said.err.count('\n') == 1 and not output.exists()
        assert said.err.startswith(f'import_vehicle: {source}: ')
        return said.err
    return read
