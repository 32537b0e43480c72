"""A specimen scene end to end on the coarsest mesh."""

import meshio
import netCDF4
import numpy as np
import pytest
import xarray as xr

from bondcell.specimen.view import error_table, read_specimen
from bondcell.storage import read_dataset

SPECIMEN = """\
title: A coarse specimen
specimen:
  lattices: [lattice_paper, lattice_fe_shear]
  loadings: [horizontal]
  elastic: {free: [2]}
  relaxation:
    series: {weights: [0.6, 0.3], times: [1, 100]}
    times: {start: 0.01, stop: 1e4, points: 5}
    methods: [lattice_fsi]
  finite_strain: {methods: [lattice_paper], directions: [+x]}
"""


@pytest.fixture(scope="module")
def first_run(make_workspace, tmp_path_factory):
    """The workspace, and what its jobs had loaded."""
    workspace = make_workspace(tmp_path_factory.mktemp("specimen"), small=SPECIMEN)
    done = workspace.snakemake()
    assert done.returncode == 0, done.stdout
    return workspace, workspace.modules()


@pytest.fixture(scope="module")
def run(first_run):
    return first_run[0]


@pytest.fixture(scope="module")
def results(run):
    return read_specimen(run / "results/small/study.nc")


def test_sources_of_a_rule_are_what_its_jobs_loaded(first_run):
    workspace, modules = first_run
    ran = [path for path in workspace.scripts() if path.stem in modules]
    assert {"specimen_part", "specimen_vtk", "specimen_field_vtk"} <= {path.stem for path in ran}
    for script in ran:
        assert workspace.undeclared(script, modules) == set(), script


def test_names_and_dimensions(results):
    study = results[""]
    methods = ["fe_elastic", "lattice_paper", "lattice_fsi", "lattice_fe_shear"]
    assert study["method"].values.tolist() == methods
    assert study["energy"].dims == ("method", "loading", "walls")
    assert study["displacement"].dims == ("method", "loading", "walls", "particle", "component")
    assert study["particle"].values.tolist() == list(range(1, 19))
    for name in ("rotation", "displacement_norm", "error_estimate", "dof", "seconds"):
        assert name in study
    assert set(results) == {"", "ladder", "bonds", "relaxation", "finite_strain", "midplane"}


def test_times_tell_how_they_were_measured(results):
    """Lattices are run several times, a solid once; each part says what else was running."""
    study = results[""]
    known = study.energy.notnull()
    assert (study.seconds_cpu > 0).where(known, True).all()
    is_solid = study.method.isin(["fe_elastic", "fe_rigid"])
    assert (study.seconds_spread >= 0).where(known & ~is_solid, True).all()
    assert study.seconds_spread.where(is_solid).isnull().all()
    threads, loads = (study.attrs[name] for name in ("threads", "load_average_before"))
    assert set(threads.split(" | ")) == {"1"}
    assert len(loads.split(" | ")) == len(threads.split(" | "))


def test_what_was_not_computed_is_nan_and_flagged(results):
    study = results[""]
    missing = study.sel({"method": "fe_elastic", "walls": "fixed"})
    assert missing["energy"].isnull().all()
    assert (missing["status"] == 7).all()
    assert (study["status"].sel({"method": "lattice_fsi"}) == 7).all()
    solved = study.sel({"method": ["fe_elastic", "lattice_paper"], "walls": "free"})
    assert (solved["status"] == 0).all()
    assert (study["energy"].isnull() == (study["status"] == 7)).all()


def test_one_mesh_says_nothing_on_its_error(results):
    study = results[""]
    assert study["reference_error"].isnull().all()
    table = error_table(results)
    assert table.loc[table["method"] == "fe_elastic", "energy_error"].isna().all()


def test_field_of_the_mid_plane_is_the_solid_s(results):
    """The mean over a particle's cut is near its mean motion; no bond stretches a fixed row."""
    study, plane = results[""], results["midplane"]
    shift = plane["displacement"].sel(loading="horizontal").transpose("vertex", ...).values
    own = plane["triangle_particle"].values
    for particle in (1, 8):
        nodes = np.unique(plane["triangle"].values[own == particle])
        expected = study["displacement"].sel(
            {"method": "fe_elastic", "walls": "free", "particle": particle}
        )
        assert shift[nodes].mean(axis=0)[0] == pytest.approx(expected.values[0, 0], rel=0.05)
    assert (
        plane["principal_stress"].sel(end="largest")
        >= plane["principal_stress"].sel(end="smallest")
    ).all()


def test_bond_forces_balance_the_energy(results):
    """Half of the normal force squared over the stiffness, summed up, is the paper's energy."""
    at = {"method": "lattice_paper", "walls": "free", "loading": "horizontal"}
    force = results["bonds"]["bond_force"].sel(at).sel(force="normal").values
    stiffness = np.where(np.arange(41) < 37, 1.05e5, 1.2e2)
    energy = float(results[""]["energy"].sel(at))
    assert (force**2 / stiffness).sum() / 2 == pytest.approx(energy, rel=1e-9)
    pairs = results["bonds"]["bond_nodes"].values
    assert pairs.min() == 1
    assert pairs.max() == 22


def test_file_is_a_described_tree(run):
    path = run / "results/small/study.nc"
    with xr.open_datatree(path) as tree:
        assert "bonds" in tree.children
    with netCDF4.Dataset(path) as file:
        assert file.Conventions == "CF-1.11"
        for group in (file, *file.groups.values()):
            for variable in group.variables.values():
                # Coordinates of text are characters, with a dimension more.
                if variable.dimensions[:1] != (variable.name,):
                    assert "long_name" in variable.ncattrs(), variable.name
                    assert {"units", "flag_values"} & set(variable.ncattrs()), variable.name


def test_files_for_paraview(run, results):
    solid = meshio.read(run / "results/small/solid_horizontal.vtu")
    assert solid.cells_dict["tetra10"].shape[1] == 10
    largest = solid.point_data["displacement_magnitude"].max()
    assert 0.5e-3 < largest < 1e-3
    lattice = meshio.read(run / "results/small/lattice_horizontal.vtu")
    assert len(lattice.cells_dict["line"]) == 37


def test_page_tells_of_it(run):
    page = (run / "results/report.html").read_text(encoding="utf-8")
    assert "A coarse specimen" in page
    for words in ("energy and norm allow", "by mode of deformation", "Particles 6 and 7"):
        assert words in page
    assert read_dataset(run / "results/small/study.nc").attrs["scene"] == "small"


def test_second_run_does_nothing(run):
    assert "Nothing to be done" in run.snakemake().stdout


def test_kept_results_come_into_the_report_unless_edited(run):
    text = SPECIMEN.replace("A coarse specimen", "The large one").split("  elastic")[0]
    run.write("params/specimen_fine.yaml", text)
    made = ("results/specimen_fine/study.nc", "results/specimen_fine/figures")
    assert run.snakemake(*made).returncode == 0
    assert run.snakemake().returncode == 0
    assert "The large one" in (run / "results/report.html").read_text(encoding="utf-8")
    run.append("params/specimen_fine.yaml", "question: Another?\n")
    assert run.snakemake("--forcerun", "report").returncode == 0
    assert "The large one" not in (run / "results/report.html").read_text(encoding="utf-8")
