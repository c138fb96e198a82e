"""Inverse kinematics, one body for all clips, bind poses."""
