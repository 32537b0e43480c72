# The jobs that compute. A batch is named after what it answers, its points stand in the manifest: the
# scene's file is `ancient`, as it may change without changing them. Elsewhere what matters of the
# scene is the digest in the parameters. Linear algebra runs on as many threads as a
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
        "results/{scene}/batches/analytic_{load}_{key}.nc",
    params:
        sources=contents("analytic.py"),
        batch=lambda w: f"analytic_{w.load}_{w.key}",
        entry=lambda w: entry_of(scene_of(w), f"analytic_{w.load}_{w.key}"),
    message:
        "{wildcards.scene}: analytic models, {params.batch}"
    script:
        "../scripts/analytic.py"


rule reference:
    input:
        scene=ancient("params/{scene}.yaml"),
        sources=sources("reference.py"),
    output:
        "results/{scene}/batches/fe_{bc}_{key}.nc",
    retries: ATTEMPTS - 1
    resources:
        mem_mb=bound(2000),
        runtime=bound(20),
        attempt=lambda wildcards, attempt: attempt,
        attempts=ATTEMPTS,
    params:
        sources=contents("reference.py"),
        batch=lambda w: f"fe_{w.bc}_{w.key}",
        entry=lambda w: entry_of(scene_of(w), f"fe_{w.bc}_{w.key}"),
    message:
        "{wildcards.scene}: finite elements, {params.batch}"
    script:
        "../scripts/reference.py"


rule relaxation_models:
    input:
        scene=ancient("params/{scene}.yaml"),
        sources=sources("relaxation_models.py"),
    output:
        "results/{scene}/batches/relaxation_models_{load}_{key}.nc",
    params:
        sources=contents("relaxation_models.py"),
        batch=lambda w: f"relaxation_models_{w.load}_{w.key}",
        entry=lambda w: entry_of(scene_of(w), f"relaxation_models_{w.load}_{w.key}"),
    message:
        "{wildcards.scene}: relaxation by models, {params.batch}"
    script:
        "../scripts/relaxation_models.py"


rule relaxation_fe:
    input:
        scene=ancient("params/{scene}.yaml"),
        sources=sources("relaxation_fe.py"),
    output:
        "results/{scene}/batches/relaxation_fe_{load}_{key}.nc",
    params:
        sources=contents("relaxation_fe.py"),
        batch=lambda w: f"relaxation_fe_{w.load}_{w.key}",
        entry=lambda w: entry_of(scene_of(w), f"relaxation_fe_{w.load}_{w.key}"),
    message:
        "{wildcards.scene}: relaxation by finite elements, {params.batch}"
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
