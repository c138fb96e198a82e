"""Keypose thresholds that are learned from annotations."""
