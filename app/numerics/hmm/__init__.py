"""Left-to-right Gaussian hidden Markov models."""
