# Files of batches and studies that no longer match their checksum are removed while the run is
# planned, and so made again. Who only looks (a dry run, --unlock, a job's own process) removes nothing.
from bondcell.sealed_files import is_whole


@cache
def is_damaged(path):
    """Whether a sealed file is there but not whole; then it is removed, or would be."""
    if not workflow.is_main_process or not Path(path).is_file() or is_whole(path):
        return False
    acts = is_acting()
    what = "removed, it is made again where it is needed" if acts else "it would be removed"
    print(f"warning: {path} does not match its checksum: {what}", file=sys.stderr)
    if acts:
        Path(path).unlink()
    return True


def is_acting():
    """Whether this process computes, or is one of a job, and not one that only looks."""
    return workflow.executor_plugin is not None and not workflow.dryrun


def checked(files):
    """Files of batches, of which the damaged ones are gone."""
    for path in files:
        is_damaged(path)
    return files


def collected_scene(wildcards):
    """The scene whose study is collected; a damaged one makes way."""
    is_damaged(study_file(wildcards.scene))
    return scene_of(wildcards)


def study_file(name):
    """File of the results of the scene of that name."""
    return f"results/{name}/study.nc"


def damaged_files(scene):
    """Files of a scene's jobs that were found damaged."""
    files = [study_file(scene.name)]
    files += convergence_files(scene) + method_files(scene) + specimen_files(scene)
    for method in ("analytic", "fe", "relaxation"):
        files += batch_files(scene, method)
    return [path for path in files if is_damaged(path)]
