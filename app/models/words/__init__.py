"""Words and motions: Takano, and the default word model."""
