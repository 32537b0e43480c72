# One file a scene: results on the swept axes, the convergence study as a group, provenance.
rule collect:
    input:
        scene=ancient("params/{scene}.yaml"),
        sources=sources("collect.py"),
        analytic=lambda wildcards: batch_files(collected_scene(wildcards), "analytic"),
        reference=lambda wildcards: batch_files(scene_of(wildcards), "fe"),
        relaxation=lambda wildcards: batch_files(scene_of(wildcards), "relaxation"),
        methods=lambda wildcards: method_files(scene_of(wildcards)),
        specimen=lambda wildcards: specimen_files(scene_of(wildcards)),
        convergence=lambda wildcards: convergence_files(scene_of(wildcards)),
    output:
        "results/{scene}/study.nc",
    params:
        sources=contents("collect.py"),
        digest=lambda wildcards: scene_of(wildcards).digest,
    message:
        "{wildcards.scene}: collect"
    script:
        "../scripts/collect.py"
