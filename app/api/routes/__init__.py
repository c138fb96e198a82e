"""One module a noun: the calls of DESIGN 8, each a thin line from HTTP to a service."""
