# Tables of an accuracy atlas, and the summary of the full one that the package ships for its advice.
rule atlas_tables:
    input:
        study="results/{scene}/study.nc",
        sources=sources("atlas_tables.py"),
    output:
        regions=report(
            "results/{scene}/accuracy_by_region.csv",
            caption="../report/accuracy_by_region.rst",
            category="{scene}",
            subcategory="tables",
            labels={"table": "accuracy by region"},
        ),
        best=report(
            "results/{scene}/best_models.csv",
            caption="../report/best_models.rst",
            category="{scene}",
            subcategory="tables",
            labels={"table": "best models"},
        ),
        time=report(
            "results/{scene}/error_against_time.csv",
            caption="../report/error_against_time.rst",
            category="{scene}",
            subcategory="tables",
            labels={"table": "error against time"},
        ),
    params:
        sources=contents("atlas_tables.py"),
    message:
        "{wildcards.scene}: error by region, best models, error against run time"
    script:
        "../scripts/atlas_tables.py"


rule accuracy_map:
    input:
        study="results/atlas/study.nc",
        sources=sources("accuracy_map.py"),
    output:
        "results/accuracy_map.npz",
    # It measures time, see rule convergence.
    threads: WHOLE_MACHINE
    params:
        sources=contents("accuracy_map.py"),
    message:
        "accuracy map: summary of the atlas for the package"
    script:
        "../scripts/accuracy_map.py"
