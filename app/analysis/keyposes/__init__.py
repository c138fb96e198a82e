"""Keyposes from energy and beats (Perera 2009, section 3)."""
