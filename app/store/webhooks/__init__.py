"""Webhooks, and the events that they receive."""
