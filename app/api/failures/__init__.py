"""Answers to failures: problems (RFC 9457)."""
