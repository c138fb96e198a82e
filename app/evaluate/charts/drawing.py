"""Common parts of all pictures: matplotlib without its global state, colors, names, bytes.

The colors are those of Okabe and Ito, which people with any color vision can distinguish. Markers
and dashes differ too, for more than seven groups and for print without color.
"""

from __future__ import annotations

import io
import warnings
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, get_args

from app.errors import BadField, ExtraNeeded
from app.kinedex_error import Place

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Format = Literal["svg", "png", "pdf"]

COLORS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#4D4D4D")
MARKERS = ("o", "s", "^", "D", "v", "P", "X", "<", "*", ">")
DASHES: tuple[str | tuple[int, tuple[int, ...]], ...] = (
    "-",
    (0, (6, 2)),
    (0, (2, 1)),
    (0, (6, 2, 1, 2)),
)
MAX_NAME_LENGTH = 24
"""Largest number of characters of a name in a picture; a longer name loses its middle."""
LEGEND_ROW = 0.19
"""Height of a row of a legend in inches."""
PNG_DOTS_PER_INCH = 150
MAX_INCHES = 40.0
"""Largest length of a side: 6,000 dots."""

_STYLE: Any = {
    "axes.axisbelow": True,
    "axes.grid": True,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlesize": 10,
    "figure.titlesize": 11,
    "font.family": "DejaVu Sans",  # part of matplotlib, so letters are the same everywhere
    "font.size": 9,
    "grid.color": "#E3E3E3",
    "legend.fontsize": 8,
    "legend.frameon": False,
    "lines.linewidth": 1.3,
    "svg.hashsalt": "kinedex",
    "text.parse_math": False,  # names come from other people and may have dollar signs
}
_NO_DATES: dict[str, dict[str, Any]] = {
    "svg": {"Date": None},
    "png": {},
    "pdf": {"CreationDate": None},
}


def format_of(path: Path) -> Format:
    """The format by the suffix of `path`. Raises BadField for an unknown suffix."""
    formats: tuple[Format, ...] = get_args(Format)
    for known in formats:
        if path.suffix.lower() == f".{known}":
            return known
    names = ", ".join(f".{known}" for known in formats)
    detail = f"A picture's name must end in one of {names}, not {path.name!r}."
    raise BadField(detail, places=[Place("picture", detail)])


def need_plots() -> None:
    """Raise ExtraNeeded without matplotlib. Call this before long work."""
    try:
        import matplotlib.figure  # noqa: F401 - takes half a second; few need it
    except ImportError as missing:
        raise ExtraNeeded.package("matplotlib", "Pictures") from missing


def rendered(draw: Callable[[Figure], None], inches: tuple[float, float], form: Format) -> bytes:
    """The bytes of a figure of `inches` (width, height) that `draw` fills."""
    need_plots()
    import matplotlib as mpl
    from matplotlib.figure import Figure

    width, height = (min(side, MAX_INCHES) for side in inches)
    with mpl.rc_context(_STYLE), warnings.catch_warnings():
        # a letter that the font lacks becomes a box; this must not raise an error
        warnings.filterwarnings("ignore", message="Glyph .* missing", category=UserWarning)
        figure = Figure(figsize=(width, height), layout="constrained")
        draw(figure)
        content = io.BytesIO()
        figure.savefig(
            content,
            format=form,
            dpi=PNG_DOTS_PER_INCH,
            metadata=_NO_DATES[form],
            bbox_inches="tight",
        )
    return content.getvalue()


def color(group: int) -> str:
    """The color of the group with this number."""
    return COLORS[group % len(COLORS)]


def marker(group: int) -> str:
    """The marker of the group with this number; with the color unlike any of 69 others."""
    return MARKERS[group % len(MARKERS)]


def dashes(group: int) -> Any:
    """The line style of the group with this number; with the color unlike any of 27 others."""
    return DASHES[group % len(DASHES)]


def shown(name: str) -> str:
    """`name` for a picture: one line, printable; a long name loses its middle."""
    clean = "".join(c if c.isprintable() else "\N{REPLACEMENT CHARACTER}" for c in name)
    if len(clean) <= MAX_NAME_LENGTH:
        return clean
    head = MAX_NAME_LENGTH * 2 // 3
    return f"{clean[:head]}…{clean[head + 1 - MAX_NAME_LENGTH :]}"


def add_legend(figure: Figure, handles: Sequence[Any], names: Sequence[str]) -> None:
    """One legend for the whole figure, at its right; none for a single unnamed group."""
    if len(names) > 1 or any(names):
        rows = max(1, int(figure.get_figheight() / LEGEND_ROW) - 1)
        columns = -(-len(names) // rows)
        legend = figure.legend(
            handles, [shown(n) for n in names], loc="outside right upper", ncols=columns
        )
        for line in legend.get_lines():  # they are thin and pale if a panel has many curves
            line.set(alpha=1.0, linewidth=1.6)
