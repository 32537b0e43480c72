# The jobs that compute. A scene's file is `ancient` because it may change without changing the
# points: what matters is the digest in the parameters. Linear algebra runs on as many threads as a
# job claims, which is one; two jobs at once use two cores.
ATTEMPTS = 3  # a job over its bounds is tried again with twice as much


def bound(first):
    """A resource that doubles with every attempt."""
    return lambda wildcards, attempt: first * 2 ** (attempt - 1)


rule analytic:
    input:
        scene=ancient("params/{scene}.yaml"),
        sources=sources("analytic.py"),
    output:
        "results/{scene}/batches/analytic_{part}.nc",
    wildcard_constraints:
        part=r"([a-z]+_)?\d+of\d+",
    params:
        sources=contents("analytic.py"),
        digest=lambda wildcards: scene_of(wildcards).models_digest,
    message:
        "{wildcards.scene}: analytic models, batch {wildcards.part}"
    script:
        "../scripts/analytic.py"


rule reference:
    input:
        scene=ancient("params/{scene}.yaml"),
        sources=sources("reference.py"),
    output:
        "results/{scene}/batches/fe_{bc}_{part}.nc",
    retries: ATTEMPTS - 1
    resources:
        mem_mb=bound(2000),
        runtime=bound(20),
        attempt=lambda wildcards, attempt: attempt,
        attempts=ATTEMPTS,
    params:
        sources=contents("reference.py"),
        digest=lambda wildcards: scene_of(wildcards).reference_digest,
    message:
        "{wildcards.scene}: finite elements ({wildcards.bc}), batch {wildcards.part}"
    script:
        "../scripts/reference.py"


rule relaxation_models:
    input:
        scene=ancient("params/{scene}.yaml"),
        sources=sources("relaxation_models.py"),
    output:
        "results/{scene}/batches/relaxation_models_{load}_{part}.nc",
    params:
        sources=contents("relaxation_models.py"),
        digest=lambda wildcards: scene_of(wildcards).relaxation_digest,
    message:
        "{wildcards.scene}: relaxation by models ({wildcards.load}), batch {wildcards.part}"
    script:
        "../scripts/relaxation_models.py"


rule relaxation_fe:
    input:
        scene=ancient("params/{scene}.yaml"),
        sources=sources("relaxation_fe.py"),
    output:
        "results/{scene}/batches/relaxation_fe_{load}_{part}.nc",
    params:
        sources=contents("relaxation_fe.py"),
        digest=lambda wildcards: scene_of(wildcards).relaxation_digest,
    message:
        "{wildcards.scene}: relaxation by finite elements ({wildcards.load}), batch {wildcards.part}"
    script:
        "../scripts/relaxation_fe.py"


WHOLE_MACHINE = 1024  # more than there are: Snakemake scales it down to all cores


rule relaxation_methods:
    input:
        scene=ancient("params/{scene}.yaml"),
        sources=sources("relaxation_methods.py"),
    output:
        "results/{scene}/batches/relaxation_methods.nc",
    # As below.
    threads: WHOLE_MACHINE
    params:
        sources=contents("relaxation_methods.py"),
        digest=lambda wildcards: scene_of(wildcards).methods_digest,
    message:
        "{wildcards.scene}: methods in time"
    script:
        "../scripts/relaxation_methods.py"


rule convergence:
    input:
        scene=ancient("params/{scene}.yaml"),
        sources=sources("convergence.py"),
    output:
        "results/{scene}/batches/convergence.nc",
    # It measures time: claiming every core keeps other jobs away while it runs on one of them.
    threads: WHOLE_MACHINE
    params:
        sources=contents("convergence.py"),
        digest=lambda wildcards: scene_of(wildcards).convergence_digest,
    message:
        "{wildcards.scene}: convergence study"
    script:
        "../scripts/convergence.py"
