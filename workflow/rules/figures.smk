rule figures:
    input:
        scene=ancient("params/{scene}.yaml"),
        study="results/{scene}/study.nc",
        sources=sources("figures.py"),
    output:
        report(
            directory("results/{scene}/figures"),
            patterns=["{figure}.svg"],
            caption="../report/figure.rst",
            category="{scene}",
            subcategory="figures",
            labels={"figure": "{figure}"},
        ),
    params:
        sources=contents("figures.py"),
        digest=lambda wildcards: scene_of(wildcards).digest,
    message:
        "{wildcards.scene}: figures"
    script:
        "../scripts/figures.py"
