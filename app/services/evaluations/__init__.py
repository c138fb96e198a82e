"""Evaluations: requests, the options of each kind, and the kept results. `app.evaluate` judges."""
