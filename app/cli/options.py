"""Options that several commands have."""

from __future__ import annotations

from typing import Annotated

import typer

FilterJson = Annotated[
    str | None,
    typer.Option(
        "--filter", help='JSON, for example {"task": ["walk", "run"], "not_source": "my studio"}.'
    ),
]
IncludeSelf = Annotated[
    bool, typer.Option("--include-self", help="Let the query itself be a hit, if it is stored.")
]
By = Annotated[
    str | None,
    typer.Option(
        "--by",
        help="Figures for each group of clips too: by person, task, license, source, folder, format"
        " or meta.KEY.",
    ),
]
PictureFormat = Annotated[
    str, typer.Option(help="Format of the pictures in a folder: svg, png or pdf.")
]
