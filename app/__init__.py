"""Kinedex: a self-hosted search engine for human motion."""

__version__ = "0.1.0"

import os

# Many requests and analysis processes share the cores: a BLAS that also starts threads for
# each small product makes all of them slower. The variable must be set before numpy is imported.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
