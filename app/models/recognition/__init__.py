"""Recognition of persons and tasks."""
