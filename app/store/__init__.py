"""The database, the arrays and the files of a library. Each repository module stores one noun."""
