"""The body frame, gait cycles and foot contacts."""
