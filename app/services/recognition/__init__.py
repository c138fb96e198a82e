"""Recognition of person and task, and words that describe a motion."""
