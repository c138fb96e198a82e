"""`kinedex evaluate words`: the tables and figures of Takano for your own library."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from app import evaluate
from app.cli.evaluate.drawing import Drawing
from app.cli.evaluate.running import parsed_filter
from app.cli.evaluate.tables import CsvFile, check_csv, keep_table, report, show_table
from app.cli.options import FilterJson
from app.cli.output import AsJson, print_table, print_text
from app.cli.settings import open_library
from app.evaluate import WordExample
from app.evaluate.words.document import word_document
from app.evaluate.words.evaluation import PAPER
from app.models.held_out.words import (
    MIN_RECORDINGS,
    RECALLS,
    JudgedWord,
    WordEvaluation,
    WordFigures,
)

Queries = Annotated[
    list[str] | None,
    typer.Option(
        "--query",
        help="Words of an example for table 2, as 'high kick'; may be repeated. "
        "Default: the most frequent words.",
    ),
]
Picture = Annotated[
    Path | None, typer.Option(help="Draw recall against precision: a .svg, .png or .pdf file.")
]
MAX_SHOWN = 40
"""Largest number of words in the printed table; --json and --csv have all."""


def words(
    context: typer.Context,
    query: Queries = None,
    filter_json: FilterJson = None,
    picture: Picture = None,
    csv_file: CsvFile = None,
    as_json: AsJson = False,
) -> None:
    """Find words for clips and clips for words, held out and in-sample."""
    check_csv(csv_file)
    filter, drawing = parsed_filter(filter_json), Drawing.prepared(picture)
    with open_library(context) as lib:
        found = evaluate.judge_words(lib, filter)
        examples = evaluate.word_examples(lib, query, filter)
    report(
        lambda: word_document(found, examples),
        lambda: _print(found, examples),
        as_json=as_json,
        csv_file=csv_file,
    )
    drawing.draw_one(lambda form: evaluate.draw_words(found, form))


def _print(found: WordEvaluation, examples: Sequence[WordExample]) -> None:
    typer.echo(
        f"{found.clips} clips, {found.words} words. Held out, {found.folds} folds by recording:\n"
    )
    _print_figures("held_out", found.figures)
    typer.echo("\nIn-sample, as the paper judged retrieval (section 3):\n")
    _print_figures("in_sample", found.in_sample)
    print_text(
        "\nTakano's figures (618 motions, 253 words) and yours: F and MAP of label sets in-sample, "
        "top-3 words with one recording left out:\n"
    )
    _print_paper(found)
    typer.echo("\nPrecision of single words at a recall, held out (figure 7):\n")
    _print_curves(found.figures)
    for method, one in found.reliability.items():
        print_text(
            f"\nScores of {method} as probabilities, held out: expected calibration error "
            f"{one.word_error:.4f} and Brier score {one.word_brier:.4f} of single words (by "
            f"frequency {one.prior_brier:.4f}); {one.set_error:.4f} and {one.set_brier:.4f} "
            "of whole label sets."
        )
    losses = ", ".join(f"{count}: {loss:.4f}" for count, loss in found.losses.items())
    print_text(f"Log loss of held-out words in the mode cca, by dimensions: {losses}.")
    for kind, correlations in found.correlations.items():
        shown = " ".join(f"{one:.3f}" for one in correlations)
        print_text(f"Canonical correlations ({kind.replace('_', '-')}): {shown}")
    typer.echo("\nWord by word, held out:\n")
    _print_words(found.by_word)
    for example in examples:
        _print_example(example)


def _print_figures(name: str, figures: Sequence[WordFigures]) -> None:
    show_table(
        name,
        ["method", "top-3 words", "word F", "word MAP", "set F", "set MAP"],
        [
            [f.method, f.top_3_recognition, f.word_f, f.word_map, f.set_f, f.set_map]
            for f in figures
        ],
    )


def _print_paper(found: WordEvaluation) -> None:
    by_method = {one.method: one for one in found.in_sample}
    own = [by_method["printed"], by_method["cca"]]
    show_table(
        "paper",
        ["", "the paper", "printed", "cca"],
        [
            ["set F", PAPER["set_f"], *(one.set_f for one in own)],
            ["set MAP", PAPER["set_map"], *(one.set_map for one in own)],
            ["top-3 words", PAPER["top_3_left_out"], *(found.left_out[m.method] for m in own)],
        ],
    )


def _print_curves(figures: Sequence[WordFigures]) -> None:
    """Print some recalls; the CSV file gets all, a row each."""
    keep_table(
        "precision_at_recall",
        ["method", "recall", "precision"],
        [
            [one.method, recall, precision]
            for one in figures
            for recall, precision in zip(RECALLS, one.precision, strict=True)
        ],
    )
    columns = range(2, len(RECALLS), 2)
    print_table(
        ["method", *(f"{RECALLS[column]:.1f}" for column in columns)],
        [[one.method, *(one.precision[column] for column in columns)] for one in figures],
    )


def _print_words(by_word: Sequence[JudgedWord]) -> None:
    judged = [one for one in by_word if not one.too_rare]
    show_table(
        "words",
        ["word", "clips", "recordings", "AP", "F", "AUC"],
        [
            [o.word, o.clips, o.recordings, o.average_precision, o.f, o.area_under_curve]
            for o in judged
        ],
        MAX_SHOWN,
    )
    if len(judged) > MAX_SHOWN:
        typer.echo(f"... and {len(judged) - MAX_SHOWN} more words; --json and --csv list all.")
    rare = [one.word for one in by_word if one.too_rare]
    if rare:
        more = "" if len(rare) <= MAX_SHOWN else f" and {len(rare) - MAX_SHOWN} more"
        print_text(
            f"Too rare to judge one by one, in fewer than {MIN_RECORDINGS} recordings: "
            f"{', '.join(rare[:MAX_SHOWN])}{more}."
        )


def _print_example(example: WordExample) -> None:
    query = " ".join(example.words)
    meant = [f"{word} as {', '.join(used)}" for word, used in example.expanded.items()]
    told = f" ({'; '.join(meant)})" if meant else ""
    typer.echo(f"\nNearest to {query}{told} in the correlated space as printed (table 2):\n")
    columns = ["clip", "distance", "distance / shortest", "carries", "words"]
    rows = [
        [near.name, near.distance, near.ratio, "yes" if near.carries else "", " ".join(near.words)]
        for near in example.nearest
    ]
    keep_table("examples", ["query", *columns], [[query, *row] for row in rows])
    print_table(columns, rows)
