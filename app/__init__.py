"""Kinedex: a self-hosted search engine for human motion."""

__version__ = "0.1.0"
