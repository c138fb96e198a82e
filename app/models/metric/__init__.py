"""Learned metrics for tasks and persons."""
