"""Use cases: ingest, find, recognise, fit, evaluate, demo library."""
