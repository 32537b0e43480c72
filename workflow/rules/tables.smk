rule accuracy:
    input:
        study="results/{scene}/study.nc",
        sources=sources("accuracy.py"),
    output:
        report(
            "results/{scene}/accuracy.csv",
            caption="../report/accuracy.rst",
            category="{scene}",
        ),
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
        ),
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
        ),
    message:
        "{wildcards.scene}: estimate, flag and cost of every point"
    script:
        "../scripts/stability.py"
