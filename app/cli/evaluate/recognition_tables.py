"""An evaluation of recognition as tables for people."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import typer

from app.cli.evaluate.confusion_table import print_confusion
from app.cli.evaluate.tables import show_table
from app.cli.output import print_text
from app.evaluate import RecognitionEvaluation
from app.evaluate.recognition.clips import names_of
from app.evaluate.recognition.perera import PereraEvaluation
from app.evaluate.recognition.results import HeldOut, Judged, LabelGiven
from app.evaluate.recognition.rounds import DRAWS, LeftOut
from app.evaluate.recognition.shares import Recognized, Share, Unknown

_LEFT_OUT_FACTORS = {LeftOut.PERSON: "person", LeftOut.TASK: "task"}
MAX_SHOWN = 40
"""Largest number of labels in a printed table; --json has all."""


def print_tables(found: RecognitionEvaluation) -> None:
    """Print the tables, the confusions of the first method, and the parts that were not judged."""
    clips = found.clips
    kinds = {"person": clips.persons, "task": clips.tasks, "source": clips.sources}
    counted = ", ".join(_counted(len(names_of(labels)), kind) for kind, labels in kinds.items())
    typer.echo(
        f"{len(clips)} clips: {counted}. No method has seen the clips that it is judged on. "
        "In parentheses: 95 % confidence intervals (Wilson)."
    )
    _print_recognized(found)
    _print_label_given(found.label_given)
    for way, factor in _LEFT_OUT_FACTORS.items():
        if way in found.held_out:
            _print_new(found.held_out[way], factor)
    if LeftOut.SOURCE in found.held_out:
        _print_sources(found.held_out[LeftOut.SOURCE])
    if found.perera is not None:
        _print_perera(found.perera)
    for kind, rows in (found.made or {}).items():
        _print_made(kind, rows)
    _print_confusions(found)
    print_text("\n" + "\n".join(_remarks(found)))


def _print_recognized(found: RecognitionEvaluation) -> None:
    if LeftOut.TAKE in found.held_out:
        _print_shares(
            "take_left_out", "A fifth of the takes left out in turn", found.held_out[LeftOut.TAKE]
        )
        _print_groups(found.held_out[LeftOut.TAKE])
    for takes, held in found.takes.items():
        title = f"{_counted(takes, 'take')} a cell learned, {DRAWS} random draws"
        _print_shares(f"{takes}_takes_learned", title, held)


def _counted(number: int, noun: str) -> str:
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def _print_shares(name: str, title: str, held: HeldOut) -> None:
    typer.echo(f"\n{title}; no label is given, the best candidate counts:\n")
    rows: list[list[object]] = [
        [one.method, *_values(one.recognized), one.recognized.both.of] for one in held.methods
    ]
    person, task, both = held.chance
    rows.append(["chance", task, person, both, held.methods[0].recognized.both.of])
    show_table(name, ["method", "task", "person", "both", "clips"], rows)


def _print_groups(held: HeldOut) -> None:
    rows: list[list[object]] = [
        [group, judged.method, *_values(one), one.both.of]
        for judged in held.methods
        for group, one in judged.by_group.items()
    ]
    if rows:
        typer.echo("\nThe same for the clips of each group:\n")
        columns = ["group", "method", "task", "person", "both", "clips"]
        show_table("groups", columns, rows)


def _values(found: Recognized) -> list[object]:
    return [found.task, found.person, found.both]


def _print_label_given(judged: Sequence[LabelGiven]) -> None:
    if not judged:
        return
    typer.echo("\nEach recording left out; the other label is given or not (Vasilescu, 5):\n")
    show_table(
        "label_given",
        ["method", "task", "person given", "person", "task given"],
        [
            [
                one.method,
                one.neither.task,
                one.given.task,
                one.neither.person,
                one.given.person,
            ]
            for one in judged
        ],
    )


def _print_new(held: HeldOut, factor: str) -> None:
    """Print the figures of left-out persons (or tasks).

    These are the share of right tasks (or persons), and how often new labels are called new.
    """
    other = "task" if factor == "person" else "person"
    typer.echo(
        f"\nEach {factor} left out in turn, in {held.rounds} rounds. {other}: right answers. new: "
        f"the left-out\n{factor} is called new. known: other clips are called known (together: a "
        "person at a\ntask that was learned):\n"
    )
    show_table(
        f"{factor}_left_out",
        ["method", other, "new", "known", "together", "balanced", "AUC", "EER", "worst"],
        [_new_row(one, factor, other) for one in held.methods],
    )
    judged = next((one for one in held.methods if factor in one.unknown), None)
    if judged is not None:
        _print_categories(judged.method, judged.unknown[factor], factor)


def _new_row(judged: Judged, factor: str, other: str) -> list[object]:
    share: Share = getattr(judged.of_new, other)
    found = judged.unknown.get(factor)
    if found is None:
        return [judged.method, share, *[None] * 7]
    return [
        judged.method,
        share,
        found.refused,
        found.accepted,
        found.accepted_together,
        found.balanced_accuracy,
        found.area_under_curve,
        found.equal_error_rate,
        found.worst.balanced_accuracy if found.worst else None,
    ]


def _print_categories(method: str, found: Unknown, factor: str) -> None:
    """Print a row for each label, the worst first."""
    ordered = sorted(found.categories, key=lambda one: (one.balanced_accuracy or 0.0, one.label))
    typer.echo(f"\nOne by one, by {method}, the worst first:\n")
    show_table(
        f"each_{factor}_left_out",
        [f"{factor} left out", "clips", "called new", "balanced", "else taken for"],
        [
            [one.label, one.refused.of, one.refused, one.balanced_accuracy, one.taken_for]
            for one in ordered
        ],
        MAX_SHOWN,
    )
    if len(ordered) > MAX_SHOWN:
        typer.echo(f"... and {len(ordered) - MAX_SHOWN} more; --json and --csv list all.")


def _print_sources(held: HeldOut) -> None:
    typer.echo("\nA source left out: its clips of tasks that other sources have too:\n")
    names = list(held.methods[0].by_name)
    show_table(
        "source_left_out",
        ["method", *(f"source {number}" for number in range(1, len(names) + 1)), "all"],
        [
            [
                one.method,
                *(one.by_name[name].task for name in names),
                one.recognized.task,
            ]
            for one in held.methods
        ],
    )
    for number, name in enumerate(names, 1):
        clips = held.methods[0].by_name[name].task.of
        typer.echo(f"source {number}: {name}, {clips} clips")
    rows: list[list[object]] = [
        [one.method, found.refused, found.accepted, found.balanced_accuracy,
         found.area_under_curve]
        for one in held.methods
        if (found := one.unknown.get("task")) is not None
    ]  # fmt: skip
    if rows:
        typer.echo("\nIts tasks that no other source has, called new:\n")
        show_table("source_left_out_new_tasks", ["method", "new", "known", "balanced", "AUC"], rows)


def _print_perera(found: PereraEvaluation) -> None:
    typer.echo(
        f"\nPerera's experiments: {found.segments} segments between keyposes, of {found.persons} "
        f"persons and {found.tasks}\ntasks; one cycle learned, another probed:\n"
    )
    rows: list[list[object]] = []
    for reading, table in found.tables.items():
        for row in table:
            balanced = row.balanced_accuracy if row.known_probed else None
            rows.append(
                [
                    row.table,
                    reading.value,
                    row.category.replace(" recognition", ""),
                    row.probed,
                    row.accuracy,
                    balanced,
                    row.paper,
                ]
            )
    columns = ["paper table", "eq. 14", "recognition", "probed", "right", "balanced", "paper"]
    show_table("perera", columns, rows)


def _print_made(kind: str, rows: Sequence[Mapping[str, Any]]) -> None:
    """Print the shares of synthesized motions whose nearest real clip has the right labels."""
    given = {"new_task": "other persons", "new_person": "other tasks"}[kind]
    typer.echo(
        f"\nMotions made for left-out cells, a {kind.replace('_', ' ')}: share with right labels "
        "of the nearest\nreal clip (Vasilescu, 7); at the right: both, by baselines and of real "
        "takes:\n"
    )
    names = ("given", "trials", "person", "task", "hit", "effects", "task_mean", "real")
    columns = [given, "trials", "person", "task", "both", "effects", "mean motion", "real"]
    show_table(f"made_{kind}", columns, [[row.get(name) for name in names] for row in rows])


def _print_confusions(found: RecognitionEvaluation) -> None:
    held = found.held_out.get(LeftOut.TAKE)
    if held is None or not held.methods:
        return
    first = held.methods[0]
    for factor, (names, shares) in first.confusion.items():
        if names:
            typer.echo(f"\nWhat {factor}s are taken for by {first.method}, takes left out, %:\n")
            print_confusion(names, shares, f"confusion_{factor}")


def _remarks(found: RecognitionEvaluation) -> list[str]:
    remarks = [
        f"{method}: {1000 * seconds.fit:.0f} ms a fit, {1000 * seconds.probe:.2f} ms a probe "
        "after its features (medians)."
        for method, seconds in found.seconds.items()
    ]
    if found.clips.unlabeled:
        remarks.append(f"{found.clips.unlabeled} clips carry neither label and were left out.")
    return remarks + [f"Not judged, {name}: {why}" for name, why in found.not_judged.items()]
