FINDINGS = "results/findings.txt"


rule report:
    input:
        scenes=lambda _: ancient([f"params/{scene.name}.yaml" for scene in study_scenes()]),
        results=lambda _: [path for scene in study_scenes() for path in scene_results(scene)],
        sources=sources("report.py"),
        templates=data_files("report/templates"),
    output:
        page=report(
            "results/report.html",
            caption="../report/report.rst",
            category="All scenes",
            labels={"page": "the report"},
        ),
        findings=FINDINGS,
    params:
        sources=contents("report.py"),
        digests=lambda _: {scene.name: scene.digest for scene in study_scenes()},
        kept=lambda _: kept_scenes(),
    message:
        "report"
    script:
        "../scripts/report.py"
