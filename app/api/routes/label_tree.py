"""The tree of labels: which task or word is a kind of which."""

from __future__ import annotations

from fastapi import APIRouter, Depends

from app.api.bodies import require_json
from app.api.deps import Lib, reads, writes
from app.api.guard.admission import changes, quick
from app.api.openapi import refusals
from app.api.schemas.label_tree import LabelParents, LabelTreeAnswer
from app.services.library import label_tree

router = APIRouter(prefix="/v1/labels", tags=["labels"])

_TREE = """\
Which task or word is a kind of which: a "right leg kick" is a "kick", and to "jog" is to "run". A
filter by a task or a word finds all kinds of it; with an equals sign (`task==kick`), it alone.

The parent of a phrase is its head, that of an inflected word its base form, and that of another
word what a lexicon of movement says. People may say otherwise: `PUT /v1/labels/tree`.
"""


@router.get("/tree", description=_TREE, dependencies=[reads, quick], responses=refusals())
def get_label_tree(lib: Lib) -> LabelTreeAnswer:
    """The tree of labels."""
    return LabelTreeAnswer.of(label_tree.get_tree(lib))


@router.put(
    "/tree",
    dependencies=[writes, Depends(require_json), changes],
    responses=refusals(400, 413, 415),
)
def put_label_tree(lib: Lib, sent: LabelParents) -> LabelTreeAnswer:
    """Say which label is a kind of which; the answer is the new tree."""
    return LabelTreeAnswer.of(label_tree.put_parents(lib, sent.parents))
