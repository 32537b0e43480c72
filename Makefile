# `make study` and `make test` set up what is missing; PYTHON=... chooses the interpreter of .venv.
SHELL := /bin/sh
.DELETE_ON_ERROR:
.DEFAULT_GOAL := help

BIN := .venv/bin
RUN := $(BIN)/python -m
STAMP := .venv/installed
CORES ?= all
# Many small systems: threads inside a process only get into each other's way.
export OMP_NUM_THREADS ?= 1
export OPENBLAS_NUM_THREADS ?= 1
# Tests share what a module prepares, so a file stays with one worker.
PARALLEL ?= -n auto --dist loadfile
# Rules may call the environment's commands by name.
WITH_PATH = PATH="$(CURDIR)/$(BIN):$$PATH"

SURROGATE = src/bondcell/models/data/surrogate.npz
ACCURACY_MAP = src/bondcell/models/data/accuracy_map.npz

.PHONY: specimen surrogate accuracy-map docs help study test test-all lint format lock schema bench setup system-deps clean

help: ## list the targets
	@sed -n 's/^\([a-z-]*\):.*## /\1\t/p' Makefile | awk -F '\t' '{ printf "make %-12s %s\n", $$1, $$2 }'

study: setup ## run the default study to results/report.html
	@sh scripts/system_deps.sh --optional
	$(WITH_PATH) $(RUN) snakemake --cores $(CORES)

test: lint ## lint, types and all tests but the slow ones
	@sh scripts/system_deps.sh --optional
	@sh scripts/browser.sh
	$(RUN) pytest $(PARALLEL) -m "not slow"

test-all: lint ## lint, types and every test
	@sh scripts/system_deps.sh --optional
	@sh scripts/browser.sh
	$(RUN) pytest $(PARALLEL)

lint: setup ## ruff, snakefmt and mypy, nothing is changed
	$(RUN) ruff check .
	$(RUN) ruff format --check .
	$(RUN) snakefmt --check Snakefile workflow
	$(RUN) mypy

format: setup ## format the sources
	$(RUN) ruff check --fix .
	$(RUN) ruff format .
	$(RUN) snakefmt Snakefile workflow

# Long, and 4 GB; what is done is not done again, and `make study` keeps it in the report.
SPECIMEN = results/specimen_fine
specimen: setup ## solve the specimen at the paper's size, 1.2 million unknowns
	@sh scripts/system_deps.sh
	$(WITH_PATH) $(RUN) snakemake --cores $(CORES) $(SPECIMEN)/figures \
		$(SPECIMEN)/solid_horizontal.vtu $(SPECIMEN)/solid_vertical.vtu \
		$(SPECIMEN)/lattice_horizontal.vtu $(SPECIMEN)/lattice_vertical.vtu

surrogate: setup ## rebuild the surrogate's data from the reference, minutes
	$(WITH_PATH) $(RUN) snakemake --cores $(CORES) results/surrogate.npz
	cp results/surrogate.npz $(SURROGATE)

accuracy-map: setup ## rebuild the data of the advice from the full atlas, minutes
	$(WITH_PATH) $(RUN) snakemake --cores $(CORES) results/accuracy_map.npz
	cp results/accuracy_map.npz $(ACCURACY_MAP)

schema: setup ## write params/*.schema.json, the scene format for editors
	$(RUN) bondcell.scenes.schema

# The pages show results of these two scenes; sphinx fetches nothing.
DOCS_SCENES = results/figure4/study.nc results/smoke/study.nc
docs: setup ## build the documentation to build/docs/index.html, warnings are errors
	@sh scripts/system_deps.sh --optional
	$(WITH_PATH) $(RUN) snakemake --cores $(CORES) $(DOCS_SCENES)
	$(RUN) sphinx -W --keep-going -q -b html docs build/docs

bench: setup ## run the benchmarks; they are no tests
	@sh scripts/system_deps.sh --optional
	@for script in benchmarks/*.py; do echo "== $$script"; $(BIN)/python "$$script" || exit 1; done

# Pins stay where they still fit; UPGRADE=1 takes the newest versions.
lock: ## resolve requirements.lock again from pyproject.toml
	@sh scripts/lock.sh $(if $(UPGRADE),--upgrade)

setup: $(STAMP) ## make .venv and install the locked dependencies
	@:

system-deps: setup ## install the system libraries of gmsh, or say which
	@sh scripts/system_deps.sh

clean: ## remove results and caches, keep .venv
	find results -mindepth 1 ! -name README.md -delete
	rm -rf .snakemake .mypy_cache .ruff_cache .pytest_cache .hypothesis build dist

# A stamp that names another folder came with a copied or moved checkout: its editable install is stale.
ifneq ($(shell test -x $(BIN)/python && cat $(STAMP) 2>/dev/null),$(shell pwd -P))
.PHONY: $(STAMP)
endif

$(STAMP): requirements.lock pyproject.toml
	@PYTHON="$(PYTHON)" sh scripts/setup_venv.sh $@
