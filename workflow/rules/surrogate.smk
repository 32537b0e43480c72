# The surrogate's data file, minutes of finite elements; `make surrogate` puts it into the package.
rule surrogate:
    input:
        sources=sources("surrogate.py"),
    output:
        "results/surrogate.npz",
    params:
        sources=contents("surrogate.py"),
    message:
        "surrogate: the finite element reference on a Chebyshev grid"
    script:
        "../scripts/surrogate.py"
