"""Pages of hits as JSON, with all members of each hit or with those that `fields=` chooses.

A page can have a thousand hits. To copy them into models, and the models into JSON, would take
longer than the search. So each hit becomes a dictionary by the fields of its model: their names,
their order, and the functions that shape a value. The clips of the hits are written one by one, and
their texts may be used again (`app.services.library.kept_clips`). `tests/api/test_hit_pages.py`
compares the answers with those of the models.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from operator import attrgetter, itemgetter
from typing import Annotated, Any, Self

from fastapi import Query, Response
from pydantic import AfterValidator, BaseModel, BeforeValidator, create_model
from pydantic.fields import FieldInfo
from pydantic_core import to_json

from app.api.schemas.base import Fields
from app.api.schemas.clips import Clip
from app.api.sparse import CACHED, refuse_unknown
from app.services.find.hits import Hits

ChosenFields = Annotated[Fields | None, Query()]
CLIP, DOT = "clip", "."
_PLACE = b'"clip":null'
"""The place of a clip's text in a page. No other member of a page has this name and no value, and
quotes in texts are escaped."""
_Names = frozenset[str] | None
"""Names of the chosen members; None for all."""
_Shape = Callable[[Any], Any]
"""A function from a value of a hit to what is shown of it."""


@dataclass(frozen=True, slots=True)
class HitPage:
    """How a page of hits is shown.

    page: the model of the page, which does not look into the items; write: from a hit to a
    dictionary, in which the clip is None; write_clip: from a hit's clip to its members;
    clip_fields: the attributes that a hit's clip needs, none if no clip is shown.
    """

    page: type[BaseModel]
    write: _Shape
    write_clip: _Shape
    clip_fields: frozenset[str]

    @classmethod
    def of(cls, page: type[BaseModel], names: list[str] | None) -> Self:
        """names: the chosen members of the items, None for all. Raises BadField."""
        return cls._of(page, None if names is None else frozenset(names))

    @classmethod
    @lru_cache(CACHED)
    def _of(cls, page: type[BaseModel], names: _Names) -> Self:
        (hit,) = page.model_fields["items"].annotation.__args__  # type: ignore[union-attr]
        refuse_unknown(hit, names or frozenset())
        unchecked: Any = list[Any]
        shell = create_model(page.__name__, __base__=page, items=(unchecked, ...))
        needed = frozenset(attribute for _, attribute, _ in _fields(Clip, _of_clip(names)))
        has_clip = names is None or any(name.partition(DOT)[0] == CLIP for name in names)
        write_clip = _writer(Clip, _of_clip(names))
        return cls(shell, _writer(hit, names), write_clip, needed if has_clip else frozenset())

    def answer(self, found: Hits) -> Response:
        """The page as JSON."""
        shown = self.page.model_validate(_Page(found, [self.write(hit) for hit in found.items]))
        written = shown.model_dump_json().encode()
        if self.clip_fields:
            first, *rest = written.split(_PLACE)
            texts = [self._text(hit.clip) for hit in found.items]
            pairs = zip(texts, rest, strict=True)
            written = b"".join([first, *(b'"clip":%b%b' % pair for pair in pairs)])
        return Response(written, media_type="application/json")

    def _text(self, clip: Any) -> bytes:
        """A clip as JSON."""
        if clip.text is not None:
            return bytes(clip.text)
        text = to_json(self.write_clip(clip))
        if clip.keep is not None:
            clip.keep(text)
        return text


class _Page:
    """The attributes of `Hits`, with items that are written already."""

    def __init__(self, found: Hits, items: list[dict[str, Any]]) -> None:
        self._found = found
        self.items = items

    def __getattr__(self, name: str) -> Any:
        return getattr(self._found, name)


def _of_clip(names: _Names) -> _Names:
    """The chosen members of the clip of a hit."""
    if names is None or CLIP in names:
        return None
    return frozenset(name.partition(DOT)[2] for name in names if name.startswith(CLIP + DOT))


def _fields(model: type[BaseModel], names: _Names) -> list[tuple[str, str, FieldInfo]]:
    """Each chosen field: its name, the attribute that it shows, and its description."""
    chosen = None if names is None else {name.partition(DOT)[0] for name in names}
    return [
        (name, str(field.validation_alias or name), field)
        for name, field in model.model_fields.items()
        if chosen is None or name in chosen
    ]


def _writer(model: type[BaseModel], names: _Names) -> _Shape:
    """From an object with the attributes of a model to a dictionary of its chosen fields."""
    fields = _fields(model, names)
    keys, attributes = [name for name, _, _ in fields], [read for _, read, _ in fields]
    shapes = [(name, shape) for name, _, field in fields for shape in _shapes(name, field)]
    read = _values_of(model, attributes)

    def write(value: Any) -> dict[str, Any]:
        shown = dict(zip(keys, read(value), strict=True))
        for name, shape in shapes:
            shown[name] = shape(shown[name])
        return shown

    return write


def _values_of(model: type[BaseModel], attributes: list[str]) -> Callable[[Any], tuple[Any, ...]]:
    """A function that reads several attributes at once."""
    if len(attributes) < 2:  # the getters return no tuple then
        return lambda value: tuple(getattr(value, name) for name in attributes)
    if model is Clip:  # a `PartialClip`, whose attributes are slower than its values
        get = itemgetter(*attributes)
        return lambda clip: get(clip.values)
    return attrgetter(*attributes)


def _no_clip(_: Any) -> None:
    return None


def _shapes(name: str, field: FieldInfo) -> list[_Shape]:
    """The functions that shape the value of a field, one after the other."""
    if field.annotation is Clip:
        return [_no_clip]  # its place
    inner = getattr(field.annotation, "__args__", (None,))[0]
    if isinstance(inner, type) and issubclass(inner, BaseModel):
        write = _writer(inner, None)
        if name == "parts":
            return [lambda items: [write(item) for item in items]]
        if name in ("origin", "group"):
            return [lambda one: None if one is None else write(one)]
    steps = (BeforeValidator, AfterValidator)
    return [one.func for one in field.metadata if isinstance(one, steps)]  # type: ignore[misc]
