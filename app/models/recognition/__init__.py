"""Who does what: recognizers of persons and tasks."""
