"""Calls: label tree. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from kinedex.call import Call, record
from kinedex.sent import given

if TYPE_CHECKING:
    from kinedex.types.label_tree import LabelTreeAnswer


def get_label_tree() -> Call[LabelTreeAnswer]:
    """Which task or word is a kind of which: a "right leg kick" is a "kick", and to "jog" is to
    "run". A filter by a task or a word finds all kinds of it; with an equals sign
    (`task==kick`), it alone.

    The parent of a phrase is its head, that of an inflected word its base form, and that of
    another word what a lexicon of movement says. People may say otherwise: `PUT
    /v1/labels/tree`.
    """
    from kinedex.types.label_tree import LabelTreeAnswer

    return Call("get_label_tree", "GET", "/v1/labels/tree", record(LabelTreeAnswer))


def put_label_tree(parents: Mapping[str, Any]) -> Call[LabelTreeAnswer]:
    """Say which label is a kind of which; the answer is the new tree.

    parents: The parent by label; null: the label has no parent. Labels that are not named get
        the parent that Kinedex finds.
    """
    from kinedex.types.label_tree import LabelTreeAnswer

    return Call(
        "put_label_tree",
        "PUT",
        "/v1/labels/tree",
        record(LabelTreeAnswer),
        json=given(parents=parents),
    )
