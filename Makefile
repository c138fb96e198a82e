# Everything a newcomer needs: `make demo` and `make test`.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.installed
BENCH_STAMP := $(VENV)/.bench-installed

.PHONY: help install demo serve test test-all bench lint picture client

help:
	@echo "make demo | serve | test | test-all | bench | lint | install | picture | client"

install: $(STAMP)

# --without-pip and pip's --python: Debian's own Python has pip but no ensurepip.
$(STAMP): pyproject.toml docker/constraints.txt
	$(PYTHON) -m venv --without-pip $(VENV)
	$(PYTHON) -m pip --python $(BIN)/python install --quiet --disable-pip-version-check \
	  --constraint docker/constraints.txt --editable ".[dev]"
	@touch $(STAMP)

demo: install
	$(BIN)/kinedex demo

serve: install
	$(BIN)/kinedex serve

lint: install
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports --no-cache

# The test runner comes last: its summary is the run's closing line. A module's tests stay
# together, since they share its fixtures.
test: lint
	OPENBLAS_NUM_THREADS=1 $(BIN)/pytest --numprocesses=logical --maxprocesses=4 --dist=loadscope

test-all: lint
	$(BIN)/pytest -m "not bench"

$(BENCH_STAMP): $(STAMP)
	$(PYTHON) -m pip --python $(BIN)/python install --quiet --disable-pip-version-check \
	  --constraint docker/constraints.txt --editable ".[dev,bench]"
	@touch $(BENCH_STAMP)

bench: $(BENCH_STAMP)
	$(BIN)/pytest -m bench -s tests/bench

# The README's picture, made from the demo library: look at it before you commit it.
picture: install
	$(BIN)/python -m tests.picture

# The calls and types of the Python client come from the OpenAPI description.
client: install
	$(BIN)/python -m tests.client.generator
