"""Checks and limits before a route: connections, hosts, API keys, bodies, queues of calls."""
