"""An evaluation of recognition as JSON."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from app.evaluate.recognition.clips import names_of
from app.evaluate.recognition.perera import PereraEvaluation
from app.evaluate.recognition.results import HeldOut, RecognitionEvaluation
from app.evaluate.recognition.shares import Category, Recognized, Share, Unknown


def recognition_document(found: RecognitionEvaluation) -> dict[str, Any]:
    """All results, with the number of clips of each share."""
    return {
        "clips": {
            "judged": len(found.clips),
            "unlabeled": found.clips.unlabeled,
            "persons": names_of(found.clips.persons),
            "tasks": names_of(found.clips.tasks),
            "sources": names_of(found.clips.sources),
        },
        "left_out": {way.value: _held_out(held) for way, held in found.held_out.items()},
        "takes_a_cell": {str(takes): _held_out(held) for takes, held in found.takes.items()},
        "told": {
            one.method: {
                "neither": _recognized(one.neither),
                "person_where_task_is_told": _share(one.given.person),
                "task_where_person_is_told": _share(one.given.task),
            }
            for one in found.label_given
        },
        "perera": _perera(found.perera),
        "made": found.made,
        "seconds": {method: asdict(seconds) for method, seconds in found.seconds.items()},
        "not_judged": dict(found.not_judged),
    }


def _held_out(held: HeldOut) -> dict[str, Any]:
    return {
        "rounds": held.rounds,
        "chance": dict(zip(("person", "task", "both"), held.chance, strict=True)),
        "methods": {
            judged.method: {
                "recognized": _recognized(judged.recognized),
                "task_in_tree": judged.task_in_tree,
                "of_what_is_new": _recognized(judged.of_new),
                "by_name": {name: _recognized(one) for name, one in judged.by_name.items() if name},
                "by_group": {name: _recognized(one) for name, one in judged.by_group.items()},
                "unknown": {factor: _unknown(one) for factor, one in judged.unknown.items()},
                "confusion": {
                    factor: {"labels": list(names), "shares": shares.tolist()}
                    for factor, (names, shares) in judged.confusion.items()
                },
            }
            for judged in held.methods
        },
    }


def _recognized(found: Recognized) -> dict[str, Any]:
    return {name: _share(getattr(found, name)) for name in ("person", "task", "both")}


def _share(share: Share) -> dict[str, Any]:
    return {
        "share": share.value,
        "right": share.right,
        "of": share.of,
        "interval_95": list(share.interval),
    }


def _unknown(found: Unknown) -> dict[str, Any]:
    return {
        "refused": _share(found.refused),
        "accepted": _share(found.accepted),
        "accepted_together": _share(found.accepted_together),
        "false_acceptance": found.false_acceptance,
        "false_rejection": found.false_rejection,
        "balanced_accuracy": found.balanced_accuracy,
        "area_under_curve": found.area_under_curve,
        "equal_error_rate": found.equal_error_rate,
        "categories": {one.label: _category(one) for one in found.categories},
        "curve": [
            {"false_acceptance": accepted, "false_rejection": rejected}
            for accepted, rejected in found.curve.tolist()
        ],
    }


def _category(one: Category) -> dict[str, Any]:
    return {
        "refused": _share(one.refused),
        "accepted": _share(one.accepted),
        "balanced_accuracy": one.balanced_accuracy,
        "taken_for": one.taken_for,
    }


def _perera(found: PereraEvaluation | None) -> dict[str, Any] | None:
    if found is None:
        return None
    counts = ("segments", "clips", "persons", "tasks")
    return {name: getattr(found, name) for name in counts} | {
        "tables": {
            reading.value: [asdict(row) | {"accuracy": row.accuracy} for row in rows]
            for reading, rows in found.tables.items()
        }
    }
