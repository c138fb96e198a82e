"""The routes, one module for each kind of object. Each route calls one function of a service."""
