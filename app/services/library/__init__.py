"""What every use case is given: the open library, its models and its analysis pool."""
