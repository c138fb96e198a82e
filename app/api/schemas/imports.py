"""Imports."""

from __future__ import annotations

from app.api.schemas.base import Incoming


class ImportForm(Incoming):
    """The text fields that come with an archive: none. The labels are in the archive's manifest."""
