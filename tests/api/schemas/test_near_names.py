"""An unknown field says which known one it may stand for; other errors stay as they are."""

from __future__ import annotations

from typing import Any

import pytest
from pydantic import BaseModel, ValidationError

from app.api.schemas.clips import ClipPatch
from app.api.schemas.evaluations import NewEvaluation
from app.api.schemas.search import MotionSearch

NO_SUCH = "This call has no such field"


def errors_of(model: type[BaseModel], sent: dict[str, Any]) -> dict[str, str]:
    """Messages by place."""
    with pytest.raises(ValidationError) as refused:
        model.model_validate(sent)
    return {".".join(map(str, one["loc"])): one["msg"] for one in refused.value.errors()}


def test_the_nearest_field_is_named() -> None:
    found = errors_of(NewEvaluation, {"kind": "symbols", "method": ["x"]})
    assert found == {"method": f"{NO_SUCH}; did you mean methods?"}


def test_a_field_inside_of_a_field_is_compared_with_its_own_siblings() -> None:
    found = errors_of(MotionSearch, {"clip_id": "x", "filter": {"persn": "ada"}})
    assert found == {"filter.persn": f"{NO_SUCH}; did you mean person?"}


def test_other_errors_of_the_same_body_stay() -> None:
    sent = {"clip_id": "x", "limt": 3, "limit": 0, "method": "best", "xyzzy": 1}
    found = errors_of(MotionSearch, sent)
    assert found["limt"] == f"{NO_SUCH}; did you mean limit?"
    assert "greater than or equal to 1" in found["limit"]
    assert "fused" in found["method"]
    assert "did you mean" not in found["xyzzy"]


def test_errors_of_our_own_validators_stay() -> None:
    alone = errors_of(ClipPatch, {"words": ["a"] * 101})
    both = errors_of(ClipPatch, {"words": ["a"] * 101, "persn": "ada"})
    assert both == alone | {"persn": f"{NO_SUCH}; did you mean person?"}
