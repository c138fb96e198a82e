"""Values of answers: objects with typed fields, pages of them, and arrays."""

from __future__ import annotations

import dataclasses
import types
from collections.abc import Callable, Iterator, Mapping
from datetime import UTC, datetime
from functools import cache
from typing import TYPE_CHECKING, Any, Generic, Self, TypeVar, get_args, get_origin

from kinedex.errors import PackageNeeded

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt
    import pandas as pd

    Array = npt.NDArray[np.float64]
else:

    class Array:
        """The type of fields that are NumPy arrays (float64)."""


Item = TypeVar("Item")
Convert = Callable[[Any], Any]


class Record:
    """A value of an answer; its subclasses are dataclasses.

    Fields that a newer service adds are ignored. Fields that an answer leaves out are None. A
    field whose name is a keyword of Python ends with an underscore, as in `global_`.
    """

    @classmethod
    def from_json(cls, document: Mapping[str, Any]) -> Self:
        """Build the value from its JSON object."""
        return cls(
            **{
                name: None if (value := document.get(name.rstrip("_"))) is None else convert(value)
                for name, convert in _converters_of(cls).items()
            }
        )

    def to_json(self) -> dict[str, Any]:
        """The value as a JSON object, as in the answer of the service."""
        fields = dataclasses.fields(self)  # type: ignore[arg-type]  # subclasses are dataclasses
        return {one.name.rstrip("_"): as_json(getattr(self, one.name)) for one in fields}


class Page(Record, Generic[Item]):
    """One page of a list: it can be iterated, indexed and shown as a table.

    next: pass it as `cursor` to get the next page; None on the last page.
    """

    items: list[Item]
    next: str | None

    def __iter__(self) -> Iterator[Item]:
        return iter(self.items)

    def __len__(self) -> int:
        return len(self.items)

    def __getitem__(self, index: int) -> Item:
        return self.items[index]

    def to_dataframe(self) -> pd.DataFrame:
        """A table with one row for each item (needs pandas).

        Fields of inner objects become columns, as in `clip.name`. Lists of words are joined.
        """
        from kinedex.tables import dataframe

        return dataframe(as_json(self.items))


def as_json(value: Any) -> Any:
    """A value of an answer as JSON: objects, lists, times as ISO 8601 in UTC, arrays as lists."""
    if isinstance(value, Record):
        return value.to_json()
    if isinstance(value, list | tuple):
        return [as_json(one) for one in value]
    if isinstance(value, Mapping):
        return {name: as_json(one) for name, one in value.items()}
    if isinstance(value, datetime):
        return value.astimezone(UTC).isoformat().replace("+00:00", "Z")
    return value.tolist() if hasattr(value, "tolist") else value


def to_array(value: Any) -> Any:
    """Nested lists of numbers as a NumPy array. Raises PackageNeeded."""
    try:
        import numpy as np
    except ImportError:
        raise PackageNeeded("numpy", "An array") from None
    return np.asarray(value, dtype=np.float64)


def _converters_of(cls: Any) -> dict[str, Convert]:
    # mypy does not know that classes can be keys of a cache
    return _converters(cls)


@cache
def _converters(cls: type[Record]) -> dict[str, Convert]:
    """A function for each field of a dataclass that converts the JSON of the field."""
    from typing import get_type_hints

    hints = get_type_hints(cls)
    fields = dataclasses.fields(cls)  # type: ignore[arg-type]  # subclasses are dataclasses
    return {field.name: _converter(hints[field.name]) for field in fields}


def _converter(hint: Any) -> Convert:
    origin, inner = get_origin(hint), get_args(hint)
    if origin is types.UnionType:
        return _of_union([one for one in inner if one is not types.NoneType])
    if origin is list:
        return _each(_converter(inner[0]))
    if origin is dict:
        return _each_value(_converter(inner[1]))
    return _of_class(hint)


def _of_class(kind: Any) -> Convert:
    if kind is Array:
        return to_array
    if kind is datetime:
        return datetime.fromisoformat
    if isinstance(kind, type) and issubclass(kind, Record):
        return kind.from_json
    return _same


def _of_union(hints: list[Any]) -> Convert:
    """A converter for a value of one of some types.

    Of several classes, an object becomes the one that has the most of its members.
    """
    if len(hints) == 1:
        return _converter(hints[0])
    classes = [one for one in hints if isinstance(one, type) and issubclass(one, Record)]
    if not classes:
        return _same

    def convert(value: Any) -> Any:
        if not isinstance(value, Mapping):
            return value
        best = max(classes, key=lambda one: len(_converters_of(one).keys() & value.keys()))
        return best.from_json(value)

    return convert


def _same(value: Any) -> Any:
    return value


def _each(convert: Convert) -> Convert:
    return _same if convert is _same else lambda values: [convert(one) for one in values]


def _each_value(convert: Convert) -> Convert:
    if convert is _same:
        return _same
    return lambda values: {name: convert(one) for name, one in values.items()}
