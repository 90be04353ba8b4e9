# Two commands for everything: `make demo` shows the tool, `make test` checks it.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
PIP := $(BIN)/python -m pip --disable-pip-version-check
LOCK := requirements-dev.txt
# The newest Python for which all that the tests need has wheels, as far as this machine has it.
NEWEST ?= $(firstword $(wildcard $(foreach version,14 13 12,/usr/bin/python3.$(version) \
	/usr/local/bin/python3.$(version) $(HOME)/.pyenv/versions/3.$(version).*/bin/python)))

.PHONY: demo test test-newest campaigns site lock clean

demo: $(VENV)/installed
	@echo "== explaining the paper's Level 0 robot (figure 18)"
	@$(BIN)/mars-asp explain examples/level0/config.mars
	@echo "== the command is $(BIN)/mars-asp: $(BIN)/mars-asp check PATH judges your robot"

test: $(VENV)/installed-dev
	@echo "== ruff"
	@$(BIN)/ruff check .
	@$(BIN)/ruff format --check .
	@echo "== making tables of the grammar and our rules, then pytest, and mypy beside them"
	@$(BIN)/mypy & types=$$!; \
		$(BIN)/python hatch_build.py && $(BIN)/mars-asp fmt --check examples docs && \
		$(BIN)/python -m pytest; tests=$$?; \
		wait $$types && exit $$tests

# The tests again, with the newest Python; those of `TESTS` alone where it is given.
test-newest:
ifeq ($(NEWEST),)
	@echo "== no Python newer than 3.11 here; name one with NEWEST=..."
else
	@$(MAKE) --no-print-directory VENV=.venv-newest PYTHON=$(NEWEST) .venv-newest/installed-dev
	@echo "== pytest with $$(.venv-newest/bin/python --version)"
	@.venv-newest/bin/python -m pytest $(TESTS)
endif

# The tests with many more random inputs and all samples, and all mutants: hours. With `TESTS`, those
# alone, and no mutants.
campaigns: $(VENV)/installed-dev
	@MARS_ASP_CAMPAIGNS=1 $(BIN)/python -m pytest $(TESTS)
ifeq ($(TESTS),)
	@$(BIN)/python -m tests.mutate
endif

# The documentation as a static site in `build/site`, in an environment of its own; a warning ends it.
# Pages about commands, findings, lints, rules and decisions are made beside the committed ones.
site: .venv-site/installed $(VENV)/installed
	@echo "== building the site"
	@rm -rf build/pages && mkdir -p build/pages
	@$(BIN)/python -m docs.reference.make_reference build/pages
	@git ls-files -z '*.md' docs examples rules LICENSE CITATION.cff ':!tests' | tar -c --null -T - | tar -x -C build/pages
	@NO_MKDOCS_2_WARNING=1 .venv-site/bin/mkdocs build --strict

.venv-site/installed: pyproject.toml
	@echo "== installing what builds the site (once)"
	@$(PYTHON) -m venv .venv-site
	@.venv-site/bin/python -m pip --disable-pip-version-check install --quiet --upgrade "pip>=25.1"
	@.venv-site/bin/python -m pip --disable-pip-version-check install --quiet --group site
	@touch $@

# Write the newest versions, for all systems and from Python 3.11 on; commit what changed.
lock: $(VENV)/bin/python
	@$(PIP) install --quiet --upgrade "pip>=25.1"
	@$(PIP) install --quiet --group lock
	@$(BIN)/uv pip compile --quiet --universal --python-version 3.11 --generate-hashes --upgrade \
		--no-header --no-annotate --group dev --all-extras pyproject.toml --output-file $(LOCK)

clean:
	rm -rf $(VENV) .venv-newest .venv-site build

$(VENV)/bin/python:
	@echo "== making a virtual environment in $(VENV)"
	@$(PYTHON) -m venv $(VENV)

$(VENV)/installed: $(VENV)/bin/python pyproject.toml
	@echo "== installing mars-asp and what it needs (once)"
	@$(PIP) install --progress-bar on -e .
	@touch $@

$(VENV)/installed-dev: $(VENV)/bin/python pyproject.toml $(LOCK)
	@echo "== installing mars-asp, what it needs and the checkers, as they are locked (once)"
	@$(PIP) install --progress-bar on --require-hashes -r $(LOCK)
	@$(PIP) install --no-deps --no-build-isolation -e .
	@touch $@ $(VENV)/installed
