"""Use cases: ingest, find, recognize, fit, evaluate, demo library."""
