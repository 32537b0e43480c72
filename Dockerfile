# The locked environment with bondcell in it:
#   docker build -t bondcell . && docker run --rm -v "$PWD/results:/bondcell/results" bondcell
# `bondcell.def` is the same for Apptainer.
FROM debian:bookworm-slim

COPY scripts/system_deps.sh /bondcell/scripts/
RUN apt-get update \
    && apt-get install -y --no-install-recommends python3 python3-venv \
        $(sh /bondcell/scripts/system_deps.sh --list) \
    && rm -rf /var/lib/apt/lists/*

WORKDIR /bondcell
COPY requirements.lock ./
RUN python3 -m venv .venv \
    && .venv/bin/python -m pip install --no-cache-dir --require-hashes -r requirements.lock

COPY pyproject.toml README.md LICENSE Snakefile ./
COPY src src
COPY workflow workflow
COPY params params
RUN ln -s workflow/profiles profiles \
    && .venv/bin/python -m pip install --no-cache-dir --no-deps --no-build-isolation -e .

ENV PATH=/bondcell/.venv/bin:$PATH OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
CMD ["snakemake", "--cores", "all"]
