"""Motion symbols (Takano): feature channels, the hidden Markov model, playback."""
