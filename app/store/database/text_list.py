"""Conditions on many texts, as one parameter.

SQLAlchemy's expanding parameters write the statement again for each execution, with one parameter
a text: for 1,000 ids that takes longer than SQLite takes to find their rows. Here the texts are one
JSON array, which the database takes apart.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from typing import Any

from sqlalchemy import Column, ColumnElement, String, bindparam
from sqlalchemy.ext.compiler import compiles
from sqlalchemy.sql.compiler import SQLCompiler
from sqlalchemy.sql.functions import FunctionElement


class _Texts(FunctionElement[str]):
    """The texts of a JSON array, as rows of a subquery."""

    name = "texts"
    inherit_cache = True


@compiles(_Texts)
def _for_sqlite(element: _Texts, compiler: SQLCompiler, **options: Any) -> str:
    array = compiler.process(element.clauses, **options)
    return f"(SELECT value FROM json_each({array}))"  # noqa: S608 - the name of a parameter


@compiles(_Texts, "postgresql")
def _for_postgresql(element: _Texts, compiler: SQLCompiler, **options: Any) -> str:
    array = compiler.process(element.clauses, **options)
    return f"(SELECT json_array_elements_text(CAST({array} AS json)))"


def is_one_of(column: Column[Any], parameter: str) -> ColumnElement[bool]:
    """The condition that a text column is one of the texts of a parameter: `as_list(texts)`."""
    texts = _Texts(bindparam(parameter, type_=String))
    return column.op("IN", is_comparison=True)(texts)


def as_list(texts: Iterable[str]) -> str:
    """The value of the parameter."""
    return json.dumps(list(texts))
