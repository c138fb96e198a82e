"""The HTTP API: the application, its routes, schemas, guards and answers to failures."""
