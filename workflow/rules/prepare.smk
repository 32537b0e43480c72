# What is planned: scenes, their batches, and the source files that each job's work rests on.
# Scenes are read when a rule asks for them, so a plan costs only what the wanted files need.
import hashlib
import sys
import warnings
from functools import cache
from pathlib import Path

from bondcell.errors import BondcellError
from bondcell.sources import PACKAGE, script_sources


wildcard_constraints:
    scene="[a-z][a-z0-9_]*",
    bc="[a-z]+",
    load="[a-z]+",
    key="[0-9a-f]{16}",


def stop_planning(errors):
    """Bad input ends the run before any job: every complaint, exit status 2."""
    print(*errors, sep="\n", file=sys.stderr)
    raise SystemExit(2)


@cache
def load(path):
    """Read a scene, or give back what is wrong with it."""
    from bondcell.scenes.parsing import load_scene

    with warnings.catch_warnings():
        warnings.showwarning = lambda message, *_: print(f"warning: {message}", file=sys.stderr)
        try:
            return load_scene(path)
        except BondcellError as error:
            return error


def scene_of(wildcards):
    """The scene that a rule's wildcards name."""
    scene = load(f"params/{wildcards.scene}.yaml")
    if isinstance(scene, BondcellError):
        stop_planning([scene])
    return scene


@cache
def study_scenes():
    """The scenes of the default study, all of them sound."""
    from bondcell.scenes.study_list import load_study_list

    try:
        names = load_study_list("params/study.yaml")
    except BondcellError as error:
        stop_planning([error])
    scenes = [load(f"params/{name}.yaml") for name in names]
    errors = [scene for scene in scenes if isinstance(scene, BondcellError)]
    if errors:
        stop_planning(errors)
    return scenes


def planned_batches(scene):
    """Batches of a scene; new ones are recorded, so that every job finds its points."""
    return plan_batches(f"results/{scene.name}/batches", scene.name)


@cache
def plan_batches(folder, name):
    from bondcell.jobs.batch_plan import plan
    from bondcell.jobs.manifest import lost_entries, read_manifest

    known = read_manifest(folder)
    lost = lost_entries(folder, known)
    if lost:
        known += recovered_entries(lost)

    def is_there(batch):
        path = f"{folder}/{batch}.nc"
        return not is_damaged(path) and Path(path).is_file()

    found = plan(load(f"params/{name}.yaml"), known, is_there)
    keep(folder, found.new)
    return found


def recovered_entries(files):
    """Entries of batches that the manifest lost, from their files; they are recorded again."""
    from bondcell.jobs.batch_files import recovered
    from bondcell.jobs.manifest import Entry

    batches = [batch for batch in map(recovered, files) if batch is not None]
    keep(Path(files[0]).parent, batches)
    return [Entry(batch.name, batch.rows, batch.hashes) for batch in batches]


def keep(folder, batches):
    """Record batches in a folder's manifest, unless this process only looks."""
    from bondcell.jobs.manifest import record

    if not is_acting():
        return
    try:
        record(folder, batches)
    except BondcellError as error:
        print(f"error: {error}", file=sys.stderr)
        raise SystemExit(1)


def batch_files(scene, kind):
    """Files of the batches of a scene's points by a kind (analytic, fe, relaxation)."""
    names = planned_batches(scene).names(kind)
    return checked([f"results/{scene.name}/batches/{name}.nc" for name in names])


def entry_of(scene, batch):
    """Entry of a batch in the manifest, where a job finds its points."""
    planned_batches(scene)
    return f"results/{scene.name}/batches/manifest/{batch}.npz"


def convergence_files(scene):
    """File of a scene's convergence study, if it has one."""
    return checked([f"results/{scene.name}/batches/convergence.nc"] if scene.convergence else [])


def method_files(scene):
    """File of a scene's comparison of methods in time, if it has one."""
    wanted = scene.prony and scene.prony.methods
    return checked([f"results/{scene.name}/batches/relaxation_methods.nc"] if wanted else [])


def specimen_files(scene):
    """Files of the jobs of a scene's specimen, if it has one."""
    block = scene.specimen
    parts = [*block.parts, *(["midplane"] if block.elastic else [])] if block else []
    return checked([f"results/{scene.name}/batches/specimen_{part}.nc" for part in parts])


def vtk_files(scene):
    """Files for ParaView of a scene's specimen: lattice and solid under each loading."""
    block = scene.specimen
    kinds = ["lattice", *(["solid"] if block.elastic else [])] if block else []
    loadings = block.loadings if block else []
    return [f"results/{scene.name}/{kind}_{way}.vtu" for kind in kinds for way in loadings]


def ladder_groups(scene):
    """Groups of a scene's file that convergence.csv tells of."""
    return [
        group
        for group, files in (
            ("convergence", convergence_files(scene)),
            ("relaxation_methods", method_files(scene)),
        )
        if files
    ]


def scene_results(scene):
    """What a scene's part of the report needs."""
    folder = f"results/{scene.name}"
    files = [f"{folder}/study.nc", f"{folder}/figures", *vtk_files(scene)]
    if scene.models and scene.reference:
        files.append(f"{folder}/accuracy.csv")
    if scene.stability:
        files.append(f"{folder}/stability.csv")
    if scene.convergence or method_files(scene):
        files.append(f"{folder}/convergence.csv")
    if scene.atlas:
        tables = ("accuracy_by_region", "best_models", "error_against_time")
        files += [f"{folder}/{table}.csv" for table in tables]
    if scene.prony:
        files += [f"{folder}/bond_series.csv", f"{folder}/bond_series.nc"]
        if scene.models and scene.reference:
            files.append(f"{folder}/accuracy_over_time.csv")
        if scene.prony.checks:
            files.append(f"{folder}/relaxation_stability.csv")
    return files


# Costly scenes that no default study computes: what they left is in the report.
KEPT = ("specimen_fine",)


def kept_scenes():
    """Names of the costly scenes that have results, with the time of these."""
    listed = {scene.name for scene in study_scenes()}
    found = {name: Path(f"results/{name}/study.nc") for name in KEPT if name not in listed}
    return {
        name: path.stat().st_mtime
        for name, path in found.items()
        if path.is_file() and Path(f"params/{name}.yaml").is_file()
    }


def sources(script):
    """The package's files that a script imports: an edit of one of them makes its jobs run again."""
    return from_here(script_sources(Path(workflow.basedir) / "workflow" / "scripts" / script))


@cache
def contents(script):
    """Digest of these files: an edit is noticed even if clocks disagree on what is newer."""
    digest = hashlib.sha256()
    for path in sources(script):
        digest.update(hashlib.sha256(Path(path).read_bytes()).digest())
    return digest.hexdigest()


def data_files(folder):
    """The package's files in a folder that holds no code."""
    return from_here(sorted(PACKAGE.joinpath(folder).iterdir()))


def from_here(paths):
    here = Path.cwd()
    return [str(path.relative_to(here) if path.is_relative_to(here) else path) for path in paths]
