"""Fitted models: versioned records of arrays, never pickled; the newest of a kind is in force."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from datetime import datetime
from typing import Any

from numpy.typing import NDArray
from sqlalchemy import RowMapping, Select, and_, delete, func, insert, select, update

from app.errors import ModelNotFitted, NotFound
from app.store.clips import versions as library
from app.store.database.blobs import from_blob, to_blob
from app.store.database.engine import Tx
from app.store.database.ids import new_id, utc_now
from app.store.database.tables import model_arrays, models

CLIP_ARRAY_PREFIX = "clips."
"""How the names of those arrays begin that hold what a model made of the clips it was fitted on."""

KEPT_VERSIONS = 2
"""Of each kind: the one in force, and the one that searches may still be reading."""


@dataclass(frozen=True, slots=True)
class ModelRecord:
    """A fitted model without its arrays. meta: JSON of the kind's own (figures, words...).

    library_version, library_size: the library that it was fitted on, size in ready clips.
    """

    id: str
    kind: str
    version: int
    library_version: int
    library_size: int
    meta: dict[str, Any]
    created_at: datetime

    @property
    def settings(self) -> dict[str, Any]:
        """What a client has set for models of this kind; a fit carries it over."""
        return dict(self.meta.get("settings", {}))


def save(
    tx: Tx,
    kind: str,
    *,
    meta: dict[str, Any],
    arrays: Mapping[str, NDArray[Any]],
    library_version: int,
    library_size: int,
) -> ModelRecord:
    """Stores a model, which is in force from the commit on; older ones than the last go."""
    library.lock(tx)
    latest = select(func.max(models.c.version)).where(models.c.kind == kind)
    version = (tx.execute(latest).scalar_one() or 0) + 1
    added = insert(models).values(
        id=new_id("model"),
        kind=kind,
        version=version,
        library_version=library_version,
        library_size=library_size,
        meta=meta,
        created_at=utc_now(),
    )
    record = _to_record(tx.execute(added.returning(models)).mappings().one())
    rows = [{"model_id": record.id, "name": name, **to_blob(a)} for name, a in arrays.items()]
    if rows:
        tx.execute(insert(model_arrays), rows)
    outdated = and_(models.c.kind == kind, models.c.version <= version - KEPT_VERSIONS)
    tx.execute(delete(models).where(outdated))
    return record


def current(tx: Tx, kind: str) -> ModelRecord:
    """The model of this kind that is in force; raises ModelNotFitted."""
    query = select(models).where(models.c.kind == kind).order_by(models.c.version.desc()).limit(1)
    row = tx.execute(query).mappings().one_or_none()
    if row is None:
        raise ModelNotFitted(f"No {kind} model has been fitted on this library yet")
    return _to_record(row)


def current_ids(tx: Tx) -> dict[str, tuple[str, dict[str, Any]]]:
    """The id in force and its settings, by kind: cheap, to see whether a loaded model is out
    of date."""
    query = _in_force(select(models.c.kind, models.c.id, models.c.meta["settings"]))
    return {kind: (model_id, dict(said or {})) for kind, model_id, said in tx.execute(query)}


def get(tx: Tx, model_id: str) -> ModelRecord:
    """A model by id; raises NotFound."""
    row = tx.execute(select(models).where(models.c.id == model_id)).mappings().one_or_none()
    if row is None:
        raise NotFound(f"There is no model with the id {model_id!r}")
    return _to_record(row)


def set_settings(tx: Tx, model_id: str, settings: Mapping[str, Any]) -> ModelRecord:
    """Changes what is set for a model; raises NotFound."""
    meta = get(tx, model_id).meta | {"settings": dict(settings)}
    tx.execute(update(models).where(models.c.id == model_id).values(meta=meta))
    return get(tx, model_id)


def list_current(tx: Tx) -> tuple[ModelRecord, ...]:
    """The models in force, by kind."""
    query = _in_force(select(models)).order_by(models.c.kind)
    return tuple(_to_record(row) for row in tx.execute(query).mappings())


def person_names(tx: Tx) -> frozenset[str]:
    """Everybody whom a stored model knows by name, in any version of it."""
    found = tx.execute(select(models.c.meta["model"]["persons"])).scalars()
    return frozenset(name for names in found for name in names or ())


def remove(tx: Tx, kinds: Collection[str]) -> int:
    """Removes every version of the models of these kinds; how many there were."""
    return tx.execute(delete(models).where(models.c.kind.in_(kinds))).rowcount


def load_arrays(
    tx: Tx, model_id: str, names: Collection[str] | None = None
) -> dict[str, NDArray[Any]]:
    """A model's arrays by name, read-only: those of these names that it has, by default all that
    make the model itself, without what it made of clips."""
    query = select(
        model_arrays.c.name, model_arrays.c.dtype, model_arrays.c.shape, model_arrays.c.data
    ).where(model_arrays.c.model_id == model_id)
    name = model_arrays.c.name
    wanted = name.not_like(f"{CLIP_ARRAY_PREFIX}%") if names is None else name.in_(names)
    found = tx.execute(query.where(wanted))
    return {name: from_blob(dtype, shape, data) for name, dtype, shape, data in found}


def _in_force(query: Select[Any]) -> Select[Any]:
    newest = select(models.c.kind, func.max(models.c.version)).group_by(models.c.kind).subquery()
    is_newest = and_(models.c.kind == newest.c[0], models.c.version == newest.c[1])
    return query.join(newest, is_newest)


def _to_record(row: RowMapping) -> ModelRecord:
    return ModelRecord(
        id=row["id"],
        kind=row["kind"],
        version=row["version"],
        library_version=row["library_version"],
        library_size=row["library_size"],
        meta=row["meta"],
        created_at=row["created_at"],
    )
