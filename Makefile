# `make run` and `make test` do everything on a fresh machine: environment, dependencies, then the work.
PYTHON ?= python3
VENV   ?= .venv
BIN    := $(VENV)/bin
STAMP  := $(VENV)/.installed
CONFIG ?= config/planks.toml
JOBS   ?= 2

# One BLAS thread a process: seven processes share the cores.
export OMP_NUM_THREADS = 1
export OPENBLAS_NUM_THREADS = 1
export MKL_NUM_THREADS = 1

.PHONY: install run test bench docs lint clean

install: $(STAMP)

run: $(STAMP)
	$(BIN)/surefoot run $(CONFIG)

test: $(STAMP)
	$(BIN)/python -P -m pytest --numprocesses $(JOBS) --dist loadfile --no-loadscope-reorder

bench: $(STAMP)
	$(BIN)/surefoot bench

docs: $(STAMP)
	$(BIN)/python -P -m sphinx -n -W --keep-going -q docs build/docs
	@echo "open build/docs/index.html"

lint: $(STAMP)
	$(BIN)/ruff check . && $(BIN)/ruff format --check . && $(BIN)/mypy

$(STAMP): pyproject.toml
	$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "Surefoot needs Python 3.11 or newer: set PYTHON=python3.11")'
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e '.[dev]'
	touch $@

clean:
	rm -rf $(VENV) build log .pytest_cache .ruff_cache .mypy_cache *.egg-info .import/*.egg-info
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
