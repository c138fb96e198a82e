"""Numerical methods: functions from arrays to arrays, independent of motion."""
