"""Words from motion and motion from words (Takano)."""
