"""Maintenance of a library: backup, verification, health and sweeps."""
