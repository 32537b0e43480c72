# Parameters -> batches of points -> study.nc -> tables and figures -> report.
#   snakemake                              every scene of params/study.yaml and the report
#   snakemake results/<scene>/study.nc     one scene, listed or not
#   snakemake results/report.html          the report
#   snakemake results/surrogate.npz        the surrogate's data, see `make surrogate`
#   snakemake results/accuracy_map.npz     the data of the advice, see `make accuracy-map`
from snakemake.utils import min_version

min_version("9.5")


report: "workflow/report/workflow.rst"


if "container" in config:  # with --sdm apptainer: the image in which jobs run, see bondcell.def

    container: config["container"]


include: "workflow/rules/prepare.smk"
include: "workflow/rules/damaged.smk"
include: "workflow/rules/compute.smk"
include: "workflow/rules/specimen.smk"
include: "workflow/rules/collect.smk"
include: "workflow/rules/tables.smk"
include: "workflow/rules/atlas.smk"
include: "workflow/rules/figures.smk"
include: "workflow/rules/report.smk"
include: "workflow/rules/surrogate.smk"
include: "workflow/rules/progress.smk"


onstart:
    say_plan()


onsuccess:
    say_findings()


onerror:
    say_failure(log)


# Seconds of work each: a cluster's queue is not for them.
localrules:
    all,
    accuracy,
    accuracy_over_time,
    atlas_tables,
    bond_series,
    convergence_table,
    figures,
    relaxation_stability,
    report,
    specimen_field_vtk,
    specimen_vtk,
    stability,


rule all:
    default_target: True
    input:
        "results/report.html",
        lambda wildcards: [path for scene in study_scenes() for path in scene_results(scene)],
        lambda wildcards: [path for scene in study_scenes() for path in damaged_files(scene)],
