"""The database, one repository a noun, arrays and files."""
