# The jobs that compute. A scene's file is `ancient` because it may change without changing the
# points: what matters is the digest in the parameters. Linear algebra runs on as many threads as a
# job claims, which is one; two jobs at once use two cores.
rule analytic:
    input:
        scene=ancient("params/{scene}.yaml"),
        sources=sources("analytic.py"),
    output:
        "results/{scene}/batches/analytic_{part}.nc",
    wildcard_constraints:
        part=r"([a-z]+_)?\d+of\d+",
    params:
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
    params:
        digest=lambda wildcards: scene_of(wildcards).reference_digest,
    message:
        "{wildcards.scene}: finite elements ({wildcards.bc}), batch {wildcards.part}"
    script:
        "../scripts/reference.py"


WHOLE_MACHINE = 1024  # more than there are: Snakemake scales it down to all cores


rule convergence:
    input:
        scene=ancient("params/{scene}.yaml"),
        sources=sources("convergence.py"),
    output:
        "results/{scene}/batches/convergence.nc",
    # It measures time: claiming every core keeps other jobs away while it runs on one of them.
    threads: WHOLE_MACHINE
    params:
        digest=lambda wildcards: scene_of(wildcards).convergence_digest,
    message:
        "{wildcards.scene}: convergence study"
    script:
        "../scripts/convergence.py"
