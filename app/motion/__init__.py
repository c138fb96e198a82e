"""Skeletons, joint roles, kinematics, the body frame: frozen values and pure functions."""
