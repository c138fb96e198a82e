"""Functions that build the calls, generated from the OpenAPI description."""
