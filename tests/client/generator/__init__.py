"""Generates the calls, the types and the groups of the Python client from the OpenAPI description.

`python -m tests.client.generator` (or `make client`) writes the files; a test compares them. So
the client cannot differ from the API.
"""
