"""The schemas of requests and answers. Each names its fields; none copies a row of the database."""
