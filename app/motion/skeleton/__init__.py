"""Skeletons, rotations, forward kinematics, sampling in time."""
