"""What an API key allows; without a database, so that `kinedex keys --help` starts at once."""

from __future__ import annotations

from enum import StrEnum


class KeyRole(StrEnum):
    """What a key allows; each role allows what those before it do."""

    READ = "read"
    """Look, search, recognize."""
    WRITE = "write"
    """Also add, change and delete clips, fit models, cancel jobs."""
    ADMIN = "admin"
    """Also whatever concerns the installation."""

    def allows(self, needed: KeyRole) -> bool:
        """Whether this role is enough where `needed` is asked for."""
        order = list(KeyRole)
        return order.index(self) >= order.index(needed)
