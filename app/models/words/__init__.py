"""Words and motions: Takano's model and the default word model."""
