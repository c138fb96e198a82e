"""How failures are answered: problems of RFC 9457."""
