"""How all pictures look: colours, dashes, a legend above the panels, and PNG and SVG alike."""

from collections.abc import Sequence
from contextlib import contextmanager
from pathlib import Path
import textwrap

import matplotlib
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
import numpy as np

WIDTH = 9.0  # of every picture [in]; 900 points of a README
DOTS_PER_INCH = 200  # of the PNG
BOUNDS = '#D4D4D4'
# Okabe and Ito's colours, which colour-blind readers can tell apart, without the yellow that print
# loses; each with dashes of its own
LINES = (('#000000', '-'), ('#0072B2', '--'), ('#D55E00', '-.'), ('#009E73', ':'),
         ('#CC79A7', (0, (6, 1, 1, 1, 1, 1))), ('#E69F00', (0, (3, 2))),
         ('#56B4E9', (0, (8, 2))))
_ROW = 0.24  # height of a row of the legend [in]
_TITLE = 0.34  # and of the picture's title [in]
_SETTING = 0.2, 118  # and of a line below it [in], and its letters
_HANDLE, _LETTER = 0.75, 0.075  # width of a line of the legend, and of a letter [in]


def line(index: int) -> dict:
    """Return colour and dashes of the line `index`; after seven the dashes move on by one."""
    colour = LINES[index % len(LINES)][0]
    return {'color': colour, 'linestyle': LINES[(index + index // len(LINES)) % len(LINES)][1]}


def dotted(text: str) -> str:
    """Return a text with units as print has them."""
    return text.replace('N*m', 'N·m').replace('v^2', 'v²')


@contextmanager
def look():
    """Use this look and no other, whatever the user's own matplotlibrc says."""
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update({
            'svg.hashsalt': 'thrust_allocator', 'font.size': 10, 'axes.titlesize': 10.5,
            'axes.labelsize': 10, 'legend.fontsize': 9.5, 'axes.spines.top': False,
            'axes.spines.right': False, 'lines.linewidth': 1.8, 'axes.titleweight': 'bold'})
        yield


def panels(rows: int, columns: int, row_height: float, title: str, legend: Sequence[Artist],
           setting: str = '', **sharing: object) -> tuple[Figure, np.ndarray]:
    """
    Return a figure and its axes (rows, columns), under a title and a legend that covers no data.

    :param row_height: of a row of panels [in].
    :param legend: what the legend shows, each with a label.
    :param setting: what the picture is of, below the title: a picture may leave its report.
    """
    below = textwrap.wrap(setting, _SETTING[1])
    legend_top = _TITLE + _SETTING[0] * len(below)
    longest = max((len(artist.get_label()) for artist in legend), default=0)
    legend_columns = max(1, min(len(legend), int(WIDTH / (_HANDLE + _LETTER * longest))))
    legend_rows = -(-len(legend) // legend_columns)
    head = legend_top + _ROW * legend_rows + (0.1 if legend else 0.0)
    height = rows * row_height + head
    figure = Figure(figsize=(WIDTH, height), layout='constrained')
    figure.get_layout_engine().set(rect=(0.0, 0.0, 1.0, 1.0 - head / height), h_pad=0.06)
    axes = figure.subplots(rows, columns, squeeze=False, **sharing)
    figure.text(0.5, 1.0 - 0.07 / height, title, ha='center', va='top', fontsize=12)
    figure.text(0.5, 1.0 - _TITLE / height, '\n'.join(below), ha='center', va='top', fontsize=10)
    if legend:
        figure.legend(handles=list(legend), loc='upper center', ncol=legend_columns,
                      frameon=False, handlelength=3.4, columnspacing=1.6,
                      bbox_to_anchor=(0.5, 1.0 - legend_top / height))
    return figure, axes


def over_speed(axes: Axes, speeds: Sequence[float], title: str, quantity: str) -> None:
    """Make axes ready for a quantity over speed."""
    axes.set(title=title, ylabel=quantity, xlim=(speeds[0], speeds[-1]))
    axes.axhline(0.0, color='black', lw=0.5)
    axes.grid(color='#E4E4E4', lw=0.6)
    axes.set_axisbelow(True)


def finish(axes: np.ndarray, used: int, label: str) -> None:
    """Take away the axes beyond the first `used` and label the x axis of the lowest ones left."""
    flat = axes.ravel()
    for one in flat[used:]:
        one.remove()
    for one in flat[max(used - axes.shape[1], 0):used]:
        one.set_xlabel(label)
        one.tick_params(labelbottom=True)


def save(figure: Figure, path: Path) -> None:
    """Write `path` with the suffixes .png and .svg; the same picture gives the same bytes."""
    figure.draw_without_rendering()
    figure.set_layout_engine('none')  # the layout is found: most of a drawing's time goes into it
    figure.savefig(path.with_suffix('.png'), dpi=DOTS_PER_INCH, metadata={'Software': None})
    figure.savefig(path.with_suffix('.svg'), metadata={'Date': None})
