rule accuracy:
    input:
        study="results/{scene}/study.nc",
        sources=sources("accuracy.py"),
    output:
        report(
            "results/{scene}/accuracy.csv",
            caption="../report/accuracy.rst",
            category="{scene}",
            subcategory="tables",
            labels={"table": "accuracy"},
        ),
    params:
        sources=contents("accuracy.py"),
    message:
        "{wildcards.scene}: error of each model against the reference"
    script:
        "../scripts/accuracy.py"


rule convergence_table:
    input:
        study="results/{scene}/study.nc",
        sources=sources("convergence_table.py"),
    output:
        report(
            "results/{scene}/convergence.csv",
            caption="../report/convergence.rst",
            category="{scene}",
            subcategory="tables",
            labels={"table": "convergence"},
        ),
    params:
        sources=contents("convergence_table.py"),
        groups=lambda wildcards: ladder_groups(scene_of(wildcards)),
    message:
        "{wildcards.scene}: error and time of each discretisation"
    script:
        "../scripts/convergence_table.py"


rule stability:
    input:
        study="results/{scene}/study.nc",
        sources=sources("stability.py"),
    output:
        report(
            "results/{scene}/stability.csv",
            caption="../report/stability.rst",
            category="{scene}",
            subcategory="tables",
            labels={"table": "stability"},
        ),
    params:
        sources=contents("stability.py"),
    message:
        "{wildcards.scene}: estimate, flag and cost of every point"
    script:
        "../scripts/stability.py"


rule accuracy_over_time:
    input:
        study="results/{scene}/study.nc",
        sources=sources("relaxation_tables.py"),
    output:
        report(
            "results/{scene}/accuracy_over_time.csv",
            caption="../report/accuracy_over_time.rst",
            category="{scene}",
            subcategory="tables",
            labels={"table": "accuracy over time"},
        ),
    params:
        sources=contents("relaxation_tables.py"),
        table="accuracy_over_time",
    message:
        "{wildcards.scene}: error of each model over time"
    script:
        "../scripts/relaxation_tables.py"


rule relaxation_stability:
    input:
        study="results/{scene}/study.nc",
        sources=sources("relaxation_tables.py"),
    output:
        report(
            "results/{scene}/relaxation_stability.csv",
            caption="../report/relaxation_stability.rst",
            category="{scene}",
            subcategory="tables",
            labels={"table": "relaxation stability"},
        ),
    params:
        sources=contents("relaxation_tables.py"),
        table="relaxation_stability",
    message:
        "{wildcards.scene}: flag, estimate and check of every series"
    script:
        "../scripts/relaxation_tables.py"


rule bond_series:
    input:
        scene=ancient("params/{scene}.yaml"),
        study="results/{scene}/study.nc",
        sources=sources("bond_series.py"),
    output:
        csv=report(
            "results/{scene}/bond_series.csv",
            caption="../report/bond_series.rst",
            category="{scene}",
            subcategory="tables",
            labels={"table": "bond series"},
        ),
        netcdf="results/{scene}/bond_series.nc",
    params:
        sources=contents("bond_series.py"),
        digest=lambda wildcards: scene_of(wildcards).digest,
    message:
        "{wildcards.scene}: the bonds' own series"
    script:
        "../scripts/bond_series.py"
