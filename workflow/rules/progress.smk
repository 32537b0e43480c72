# What a run says of itself: how far it is (the logger plugin of the profiles shows it), and at the
# end where the report is and what it says first.
from time import monotonic

from bondcell.jobs.progress import POINT_RULES, RUN, Planned


@cache
def batch_points(folder):
    """Batch -> how many points it has."""
    from bondcell.jobs.manifest import read_manifest

    return {entry.name: len(entry.hashes) for entry in read_manifest(folder)}


def planned(job):
    """A job as the line of progress counts it."""
    scene, kind = job.wildcards.get("scene", ""), job.rule.name
    file = Path(job.output[0]) if job.output else Path(kind)
    points = batch_points(file.parent).get(file.stem, 0) if kind in POINT_RULES else 0
    return Planned(f"{scene}: {file.stem}", scene, kind, points)


def say_plan():
    """Tell the line of progress what is going to run."""
    jobs = {job.jobid: planned(job) for job in workflow.dag.needrun_jobs()}
    RUN.plan({key: job for key, job in jobs.items() if job.rule != "all"}, monotonic())


def say_findings():
    """Where the report is and its main findings, if this run made it."""
    if any(job.rule == "report" for job in RUN.jobs.values()):
        print(Path(FINDINGS).read_text(encoding="utf-8").rstrip(), file=sys.stderr)


def say_failure(log):
    """Where everything is that was said."""
    told = f"not complete: {', '.join(log)} has all messages"
    print(f"{told}; what can be done without the failed jobs is done", file=sys.stderr)
