"""`kinedex evaluate recognition`: who does what, held out, for one's own library."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from app.cli.find import filter_of
from app.cli.options import FilterJson, PictureFormat
from app.cli.output import AsJson, print_json, progress_bar
from app.cli.recognition_document import document
from app.cli.recognition_tables import print_tables
from app.cli.settings import open_library
from app.search.filters import parse_filter
from app.services import evaluate, pictures
from app.services.evaluate import RecognitionEvaluation, recognition_pictures

Methods = Annotated[
    list[str] | None,
    typer.Option(
        "--method",
        help=f"Judge this one; may be repeated. One of {', '.join(evaluate.RECOGNISERS)}.",
    ),
]
Rate = Annotated[
    float | None,
    typer.Option(
        "--false-accept-rate",
        help="Of default and perera, 0..1: how often something new may be called known.",
    ),
]
Pictures = Annotated[
    Path | None,
    typer.Option("--pictures", help="Draw confusions and curves of the unknown into this folder."),
]


def recognition(
    context: typer.Context,
    method: Methods = None,
    false_accept_rate: Rate = None,
    filter_json: FilterJson = None,
    pictures_dir: Pictures = None,
    picture_format: PictureFormat = "svg",
    as_json: AsJson = False,
) -> None:
    """Person and task, held out by take, person, task and source (Vasilescu; Perera, 5)."""
    wanted = parse_filter(filter_of(filter_json))
    drawing = _Drawing.prepared(pictures_dir, picture_format)
    with open_library(context) as lib, progress_bar() as bar:
        task = bar.add_task("asking", total=None)
        found = evaluate.judge_recognition(
            lib,
            wanted,
            tuple(method or evaluate.RECOGNISERS),
            false_accept_rate=false_accept_rate,
            progress=lambda done, total: bar.update(task, completed=done, total=total),
        )
    drawing.draw(found)
    if as_json:
        print_json(document(found))
    else:
        print_tables(found)


@dataclass(frozen=True, slots=True)
class _Drawing:
    """Where pictures go; checked before the work, so that it is not done in vain."""

    folder: Path | None
    form: pictures.Format

    @classmethod
    def prepared(cls, folder: Path | None, picture_format: str) -> _Drawing:
        form = pictures.format_of(Path(f"picture.{picture_format}"))
        if folder is not None:
            pictures.need_plots()
        return cls(folder, form)

    def draw(self, found: RecognitionEvaluation) -> None:
        if self.folder is not None:
            self.folder.mkdir(parents=True, exist_ok=True)
            for name, content in recognition_pictures.all_figures(found, self.form).items():
                (self.folder / name).write_bytes(content)
