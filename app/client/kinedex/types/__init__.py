"""Types of what calls send and answer, generated from the OpenAPI description."""
