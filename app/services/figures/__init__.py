"""Stick figures as SVG."""
