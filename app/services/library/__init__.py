"""The open library that every use case gets, with its models and its analysis pool."""
