"""The engine, the schema and the tables."""
