"""Looking after a library: backup, verification, health and sweeping."""
