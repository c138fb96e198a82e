"""Fitted models: versioned records with arrays, never pickled.

The newest version of a kind is the current one.
"""

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
"""Prefix of the names of arrays with one row for each clip that the model was fitted on."""

KEPT_VERSIONS = 2
"""Versions of each kind that are stored: the current one, and the one before it, which searches
may still be reading."""


@dataclass(frozen=True, slots=True)
class ModelRecord:
    """A fitted model without its arrays.

    meta: JSON whose members depend on the kind (figures, words...); library_version: of the
    library that it was fitted on; library_size: its number of ready clips.
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
        """The settings of a client for this kind of model; a new fit keeps them."""
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
    """Stores a new version, which is the current one after the commit.

    Versions before the last KEPT_VERSIONS are deleted.
    """
    library.lock(tx)  # so that two writers do not choose the same version
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
    """The current model of this kind; raises ModelNotFitted."""
    query = select(models).where(models.c.kind == kind).order_by(models.c.version.desc()).limit(1)
    row = tx.execute(query).mappings().one_or_none()
    if row is None:
        raise ModelNotFitted(f"No {kind} model has been fitted on this library yet")
    return _to_record(row)


def current_ids(tx: Tx) -> dict[str, tuple[str, dict[str, Any]]]:
    """The id and the settings of the current model, by kind.

    This is cheap: a caller can check with it whether a loaded model is out of date.
    """
    query = _newest_only(select(models.c.kind, models.c.id, models.c.meta["settings"]))
    rows = tx.execute(query)
    return {kind: (model_id, dict(settings or {})) for kind, model_id, settings in rows}


def get(tx: Tx, model_id: str) -> ModelRecord:
    """A model by id; raises NotFound."""
    row = tx.execute(select(models).where(models.c.id == model_id)).mappings().one_or_none()
    if row is None:
        raise NotFound(f"There is no model with the id {model_id!r}")
    return _to_record(row)


def set_settings(tx: Tx, model_id: str, settings: Mapping[str, Any]) -> ModelRecord:
    """Replaces the settings of a model; raises NotFound."""
    meta = get(tx, model_id).meta | {"settings": dict(settings)}
    tx.execute(update(models).where(models.c.id == model_id).values(meta=meta))
    return get(tx, model_id)


def list_current(tx: Tx) -> tuple[ModelRecord, ...]:
    """The current models, sorted by kind."""
    query = _newest_only(select(models)).order_by(models.c.kind)
    return tuple(_to_record(row) for row in tx.execute(query).mappings())


def person_names(tx: Tx) -> frozenset[str]:
    """The names of all persons in stored models, in every version."""
    name_lists = tx.execute(select(models.c.meta["model"]["persons"])).scalars()
    return frozenset(name for names in name_lists for name in names or ())


def remove(tx: Tx, kinds: Collection[str]) -> int:
    """Removes all versions of the models of these kinds; returns their number."""
    return tx.execute(delete(models).where(models.c.kind.in_(kinds))).rowcount


def load_arrays(
    tx: Tx, model_id: str, names: Collection[str] | None = None
) -> dict[str, NDArray[Any]]:
    """Arrays of a model by name, read-only.

    names: the arrays to load; those that the model does not have are left out. None loads all
    arrays except those with a row for each clip (CLIP_ARRAY_PREFIX).
    """
    query = select(
        model_arrays.c.name, model_arrays.c.dtype, model_arrays.c.shape, model_arrays.c.data
    ).where(model_arrays.c.model_id == model_id)
    name = model_arrays.c.name
    is_requested = name.not_like(f"{CLIP_ARRAY_PREFIX}%") if names is None else name.in_(names)
    rows = tx.execute(query.where(is_requested))
    return {name: from_blob(dtype, shape, data) for name, dtype, shape, data in rows}


def _newest_only(query: Select[Any]) -> Select[Any]:
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
