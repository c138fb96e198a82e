"""Arrays of clips by name, each with the version of the analysis that computed it."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

from numpy.typing import NDArray
from sqlalchemy import bindparam, delete, insert, select

from app.errors import NotFound
from app.store.clips.repository import in_batches
from app.store.database.blobs import from_blob, from_blob_if_whole, to_blob
from app.store.database.engine import Tx
from app.store.database.tables import clip_arrays
from app.store.database.text_list import as_list, is_one_of

_CONTENT = (clip_arrays.c.dtype, clip_arrays.c.shape, clip_arrays.c.data)

# Built once: to build a statement takes longer than to execute it, and every search executes these.
_NAMED = select(clip_arrays.c.name, *_CONTENT).where(
    clip_arrays.c.clip_id == bindparam("the_id"),
    clip_arrays.c.name.in_(bindparam("names", expanding=True)),
)
_OF_MANY = select(clip_arrays.c.clip_id, *_CONTENT).where(
    is_one_of(clip_arrays.c.clip_id, "ids"),
    clip_arrays.c.name == bindparam("the_name"),
)
_OF_VERSION = _OF_MANY.where(clip_arrays.c.version == bindparam("the_version"))
_ADD = insert(clip_arrays)
_DELETE_ALL = delete(clip_arrays).where(clip_arrays.c.clip_id == bindparam("the_id"))


def put_many(tx: Tx, clip_id: str, arrays: Mapping[str, NDArray[Any]], *, version: int) -> None:
    """Stores the arrays of a clip; they replace all its earlier arrays."""
    delete_all(tx, clip_id)
    rows = [
        {"clip_id": clip_id, "name": name, "version": version, **to_blob(array)}
        for name, array in arrays.items()
    ]
    if rows:
        tx.execute(_ADD, rows)


def put_some(tx: Tx, clip_id: str, arrays: Mapping[str, NDArray[Any]], *, version: int) -> None:
    """Stores some arrays of a clip; they replace only arrays with the same names."""
    named = clip_arrays.c.name.in_(list(arrays))
    tx.execute(delete(clip_arrays).where(clip_arrays.c.clip_id == clip_id, named))
    tx.execute(
        _ADD,
        [
            {"clip_id": clip_id, "name": name, "version": version, **to_blob(array)}
            for name, array in arrays.items()
        ],
    )


def get_one(tx: Tx, clip_id: str, name: str) -> NDArray[Any]:
    """One array, read-only; raises NotFound."""
    return get_named(tx, clip_id, (name,))[name]


def get_named(tx: Tx, clip_id: str, names: Collection[str]) -> dict[str, NDArray[Any]]:
    """Some arrays of a clip by name, read-only, in the order of `names`; raises NotFound."""
    arrays = get_some(tx, clip_id, names)
    for name in names:
        if name not in arrays:
            raise NotFound(f"The clip {clip_id!r} has no array {name!r}")
    return {name: arrays[name] for name in names}


def get_some(tx: Tx, clip_id: str, names: Collection[str]) -> dict[str, NDArray[Any]]:
    """As `get_named`, but arrays that the clip does not have are left out."""
    rows = tx.execute(_NAMED, {"the_id": clip_id, "names": list(names)})
    return {name: from_blob(dtype, shape, data) for name, dtype, shape, data in rows}


def get_many(
    tx: Tx, clip_ids: Collection[str], name: str, *, version: int | None = None
) -> dict[str, NDArray[Any]]:
    """One array of many clips by clip id, read-only, in the order of `clip_ids`.

    Clips without the array, or whose array is damaged, are left out. With `version`, clips whose
    array has another version are left out too.
    """
    array_of: dict[str, NDArray[Any]] = {}
    for batch in in_batches(clip_ids):
        parameters = {"ids": as_list(batch), "the_name": name}
        if version is None:
            rows = tx.execute(_OF_MANY, parameters)
        else:
            rows = tx.execute(_OF_VERSION, parameters | {"the_version": version})
        for clip_id, *content in rows.all():
            array = from_blob_if_whole(*content)
            if array is not None:
                array_of[clip_id] = array
    return {clip_id: array_of[clip_id] for clip_id in clip_ids if clip_id in array_of}


def delete_all(tx: Tx, clip_id: str) -> None:
    """Removes all arrays of a clip."""
    tx.execute(_DELETE_ALL, {"the_id": clip_id})
