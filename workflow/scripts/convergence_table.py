"""Error, work and observed order of each discretisation, and of each method in time."""

import pandas as pd

from bondcell.jobs.job import job
from bondcell.results.convergence import convergence_table
from bondcell.results.relaxation_names import METHODS
from bondcell.results.relaxation_tables import methods_table
from bondcell.storage import read_dataset, replacing

with job(f"{snakemake.wildcards.scene}: convergence.csv") as log:
    makers = {"convergence": convergence_table, METHODS: methods_table}
    study = snakemake.input.study
    table = pd.concat(
        [makers[group](read_dataset(study, group)) for group in snakemake.params.groups]
    )
    with replacing(snakemake.output[0]) as path:
        table.to_csv(path, index=False)
    log.result = f"{len(table)} rows"
