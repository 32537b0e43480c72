"""The fullest lattice of a specimen under one loading, for ParaView."""

from bondcell.jobs import job
from bondcell.specimen_names import LATTICES
from bondcell.specimen_vtk import write_lattice_result
from bondcell.storage import read_dataset, replacing

with job(f"{snakemake.wildcards.scene}: lattice, {snakemake.wildcards.loading}"):
    study, bonds = (read_dataset(snakemake.input.study, group) for group in (None, "bonds"))
    method = [name for name in LATTICES if name in bonds["method"].values][-1]
    walls = bonds["walls"].values[0]
    at = {"method": method, "loading": snakemake.wildcards.loading, "walls": walls}
    with replacing(snakemake.output[0]) as path:
        write_lattice_result(path, study.sel(at), bonds.sel(at))
