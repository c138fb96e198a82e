"""Who is it, what do they do, and which words fit."""
