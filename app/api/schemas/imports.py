"""Imports."""

from __future__ import annotations

from app.api.schemas.base import Incoming


class ImportForm(Incoming):
    """The text fields that come with an archive: none; labels stand in its manifest."""
