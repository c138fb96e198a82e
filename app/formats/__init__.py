"""Bytes to recordings and back, one module a format, and sniffing."""
