"""The roles of API keys. This module imports no database, so that `kinedex keys --help` is fast."""

from __future__ import annotations

from enum import StrEnum


class KeyRole(StrEnum):
    """What a key allows. Each role includes the rights of the roles above it in this list."""

    READ = "read"
    """Read, search, recognize."""
    WRITE = "write"
    """Also add, change and delete clips, fit models, cancel jobs."""
    ADMIN = "admin"
    """Also manage the installation."""

    def allows(self, needed: KeyRole) -> bool:
        """Whether this role has all rights of the role `needed`."""
        order = list(KeyRole)
        return order.index(self) >= order.index(needed)
