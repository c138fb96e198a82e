"""Inverse kinematics, the canonical body, and rotations from files."""
