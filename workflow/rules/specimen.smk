# The specimen's jobs; those that measure time claim the machine, see rule convergence.
rule specimen_part:
    input:
        scene=ancient("params/{scene}.yaml"),
        sources=sources("specimen_part.py"),
    output:
        "results/{scene}/batches/specimen_{part}.nc",
    wildcard_constraints:
        part="lattices|fe_rigid|relaxation|finite_strain",
    threads: WHOLE_MACHINE
    params:
        sources=contents("specimen_part.py"),
        digest=lambda wildcards: scene_of(wildcards).specimen_digest,
    message:
        "{wildcards.scene}: {wildcards.part}"
    script:
        "../scripts/specimen_part.py"


rule specimen_elastic:
    input:
        scene=ancient("params/{scene}.yaml"),
        sources=sources("specimen_part.py"),
    output:
        "results/{scene}/batches/specimen_fe_elastic.nc",
        "results/{scene}/batches/specimen_field.nc",
        "results/{scene}/batches/specimen_midplane.nc",
    threads: WHOLE_MACHINE
    params:
        sources=contents("specimen_part.py"),
        digest=lambda wildcards: scene_of(wildcards).specimen_digest,
    message:
        "{wildcards.scene}: fe_elastic"
    script:
        "../scripts/specimen_part.py"


rule specimen_vtk:
    input:
        study="results/{scene}/study.nc",
        sources=sources("specimen_vtk.py"),
    output:
        "results/{scene}/lattice_{loading}.vtu",
    wildcard_constraints:
        loading="horizontal|vertical",
    params:
        sources=contents("specimen_vtk.py"),
    message:
        "{wildcards.scene}: lattice for ParaView ({wildcards.loading})"
    script:
        "../scripts/specimen_vtk.py"


rule specimen_field_vtk:
    input:
        scene=ancient("params/{scene}.yaml"),
        field="results/{scene}/batches/specimen_field.nc",
        sources=sources("specimen_field_vtk.py"),
    output:
        "results/{scene}/solid_{loading}.vtu",
    wildcard_constraints:
        loading="horizontal|vertical",
    params:
        sources=contents("specimen_field_vtk.py"),
        digest=lambda wildcards: scene_of(wildcards).specimen_digest,
    message:
        "{wildcards.scene}: solid for ParaView ({wildcards.loading})"
    script:
        "../scripts/specimen_field_vtk.py"
