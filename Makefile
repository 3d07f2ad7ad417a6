# Every target sets up what it needs first; docs/setup.md says what that is.
PYTHON ?= python3
WORKERS ?= 2
# Each worker draws with its own llvmpipe; more threads than cores only slow both down.
LP_NUM_THREADS ?= 1
TESTS ?= tests

BIN := .venv/bin
OUT := examples/out
PYTEST = LP_NUM_THREADS=$(LP_NUM_THREADS) $(BIN)/pytest -q

.PHONY: help setup demo examples models test test-slow test-blender fuzz bench flip-agreement lint format lock \
    clean validator browser
.DEFAULT_GOAL := help

help:
	@echo "make demo       annotate the example level: table, annotated level and pictures"
	@echo "make test       run the tests (TESTS=tests/scenes for a part of them)"
	@echo "make lint       check style, types and imports"
	@echo "make format     put the code into shape"
	@echo "make models     learn the shipped models from the committed evidence again"
	@echo "make test-slow  run the tests that take minutes"
	@echo "make test-blender  test the Blender extension in a real Blender (loads 400 MB once)"
	@echo "make fuzz       feed the readers 100,000 broken files, and the service as many"
	@echo "make bench      time the techniques; let nothing else run beside it"
	@echo "make flip-agreement  compare the error figures with FLIP on 264 views (7 minutes)"
	@echo "make examples   write the example level again"
	@echo "make lock       resolve the locked versions again"
	@echo "make clean      remove everything that make made"

setup:
	@PYTHON="$(PYTHON)" bash .ci/setup

demo: setup
	@mkdir -p $(OUT)
	$(BIN)/gnomon annotate examples/street.glb -o $(OUT)/street.annotated.glb --pictures $(OUT)
	@echo
	@echo "The level that was read:     examples/street.glb"
	@echo "The level with annotations:  $(OUT)/street.annotated.glb"
	@echo "A picture of each candidate: $(OUT)/*.png"

examples: setup
	$(BIN)/python examples/write.py
	cp examples/street.glb api/service/page/street.glb

models: setup
	$(BIN)/gnomon train --evidence models/evidence/corpus --device llvmpipe -o models/shipped/llvmpipe.model

test: setup validator
	$(PYTEST) -n $(WORKERS) -m "not slow" $(TESTS)

# The readers' tests and the annotation's ask Khronos' validator, which is a Node package.
validator:
	@if command -v npm >/dev/null; then \
	    cd tests/validator && \
	    if [ node_modules/.package-lock.json -nt package-lock.json ]; then :; \
	    else npm ci --loglevel=error --no-audit --no-fund && touch node_modules/.package-lock.json; fi; \
	else echo "npm is not here: the tests that ask the glTF validator will be skipped."; fi

# The page of the service is tested in Debian's Chromium.
browser:
	@if command -v chromium >/dev/null; then :; \
	elif [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null; then \
	    echo "installing chromium (the tests of the page need a browser)"; \
	    apt-get update -qq && apt-get install -y -qq --no-install-recommends chromium >/dev/null; \
	else echo "chromium is not here: the tests of the page in a browser will be skipped."; fi

test-slow: setup validator browser
	$(PYTEST) -m slow --timeout 3600 $(TESTS)
	GNOMON_CORPUS_EXAMPLES=15 $(PYTEST) -n $(WORKERS) --timeout 3600 tests/scenes/test_corpus_families.py

test-blender: setup
	PYTHON="$(PYTHON)" bash plugins/blender/test.sh

fuzz: setup
	GNOMON_FUZZ_EXAMPLES=20000 $(PYTEST) -n $(WORKERS) --timeout 36000 tests/scenes/test_*_fuzz.py
	GNOMON_FUZZ_EXAMPLES=34000 $(PYTEST) -n $(WORKERS) --timeout 36000 tests/api/service/test_service_fuzz.py

bench: setup
	$(BIN)/python -m tests.bench.reading
	$(BIN)/python tests/bench/frames.py
	$(BIN)/python tests/bench/techniques.py
	$(BIN)/python tests/bench/store.py
	$(BIN)/python tests/bench/benchmarking.py
	$(BIN)/python tests/bench/service.py
	$(BIN)/python tests/bench/drift_power.py

flip-agreement: setup
	$(BIN)/python tests/bench/flip_agreement.py

lint: setup
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy
	$(BIN)/lint-imports

format: setup
	$(BIN)/ruff check --fix
	$(BIN)/ruff format

lock: setup
	$(BIN)/uv pip compile --quiet --upgrade --universal --generate-hashes --no-emit-index-url --no-emit-find-links \
	    --custom-compile-command "make lock" --extra dev pyproject.toml -o requirements.lock

clean:
	rm -rf .venv .venv-blender $(OUT) build dist tests/validator/node_modules
	rm -rf .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache
	find . -name __pycache__ -prune -exec rm -rf {} +
