# Tables of an accuracy atlas.
rule atlas_tables:
    input:
        study="results/{scene}/study.nc",
        sources=sources("atlas_tables.py"),
    output:
        regions=report(
            "results/{scene}/accuracy_by_region.csv",
            caption="../report/accuracy_by_region.rst",
            category="{scene}",
        ),
        best=report(
            "results/{scene}/best_models.csv",
            caption="../report/best_models.rst",
            category="{scene}",
        ),
        time=report(
            "results/{scene}/error_against_time.csv",
            caption="../report/error_against_time.rst",
            category="{scene}",
        ),
    message:
        "{wildcards.scene}: error by region, best models, error against run time"
    script:
        "../scripts/atlas_tables.py"
