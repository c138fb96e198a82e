"""Gait: foot strikes, strides, their parameters, and angles over the gait cycle."""
