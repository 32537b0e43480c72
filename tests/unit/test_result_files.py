"""Files of results as others see them: the CF conventions, the catalogue of variables, sizes."""

from pathlib import Path

import netCDF4
import numpy as np
import pytest
import xarray as xr
from compliance_checker.runner import CheckSuite

from bondcell.cli import main
from bondcell.jobs.batch_files import write_batch
from bondcell.jobs.batch_plan import plan
from bondcell.jobs.collect import collect, collect_convergence, collect_other_loads
from bondcell.jobs.collect_relaxation import collect_methods
from bondcell.jobs.convergence_run import run_convergence
from bondcell.jobs.reference_batch import compute_reference
from bondcell.jobs.relaxation_batch import compute_relaxation
from bondcell.jobs.relaxation_methods import run_methods
from bondcell.outputs import STIFFNESS_UNITS
from bondcell.results.variables import groups
from bondcell.scenes.parsing import load_scene, parse_scene
from bondcell.scenes.study import build_study
from bondcell.specimen.files import collect_specimen
from bondcell.specimen.run import run_part
from bondcell.storage import CONVENTIONS, read_dataset, write_dataset

PARAMS = Path(__file__).parents[2] / "params"
CELL = {
    "radius_i": "7.5 mm", "gap": "0.5 mm", "young_i": "30 GPa", "poisson_i": 0.25,
    "young_m": "1.4 MPa", "poisson_m": 0.3,
}  # fmt: skip
SWEEP = {
    "title": "A sweep",
    "cell": CELL,
    "sweep": {"gap": ["0.5 mm", "2 mm"], "modulus_ratio": [10, "rigid"]},
    "models": ["fsi", "generatrix"],
    "reference": {"tolerance": 1e-2},
    "load": ["normal", "bending"],
    "contributions": True,
    "convergence": {"cases": {"base": {}}, "orders": [3, 4], "repeats": 1},
}
RELAXING = {
    "title": "Relaxing",
    "cell": CELL,
    "models": ["fsi"],
    "prony": {
        "series": {"two": {"weights": [0.5, 0.45], "times": ["1 ms", "2 s"]}},
        "times": {"start": "1 us", "stop": "100 s", "points": 5},
        "bond": {"models": ["fsi"], "terms": 2},
    },
}
SPECIMEN = {"title": "Lattices", "specimen": {"lattices": ["lattice_paper", "lattice_fsi"]}}
DESIGN = {
    "title": "A design beside a sweep",
    "cell": CELL,
    "sweep": {"gap": ["0.5 mm", "2 mm"]},
    "design": {
        "kind": "sobol",
        "points": 3,
        "ranges": {
            "modulus_ratio": {"start": 10, "stop": 1e4, "spacing": "log"},
            "poisson_m": {"start": 0, "stop": 0.4},
        },
    },
    "models": ["fsi"],
    "reference": {"tolerance": 1e-2},
    "load": ["normal", "shear"],
}
EXAMPLES = {"sweep": SWEEP, "design": DESIGN, "relaxing": RELAXING, "specimen": SPECIMEN}


def run(scene, folder: Path) -> Path:
    """All that a scene's jobs do, one after the other in this process."""
    batches = folder / "batches"

    def write(name, data, digest):
        write_batch(data, batches / f"{name}.nc", digest)

    study = build_study(scene) if scene.has_points else None
    for batch in plan(scene).new:
        if batch.name.startswith("fe"):
            write(batch.name, compute_reference(batch), batch.name)
        elif batch.name.startswith("relaxation"):
            write(batch.name, compute_relaxation(batch, scene.prony), batch.name)
    if scene.convergence:
        write("convergence", run_convergence(scene), scene.convergence_digest)
    if scene.prony and scene.prony.methods:
        write("relaxation_methods", run_methods(scene), scene.methods_digest)
    if scene.specimen:
        for part in scene.specimen.parts:
            names = (part, *(("field", "midplane") if part == "fe_elastic" else ()))
            for name, data in zip(names, run_part(scene, part), strict=True):
                write(f"specimen_{name}", data, scene.specimen_digest)
        kept = [path for path in batches.glob("*.nc") if path.stem != "specimen_field"]
        root, beside = collect_specimen(scene, kept)
    else:
        curves = sorted(batches.glob("relaxation_[mf][oe]*.nc"))
        files = scene, study, [], sorted(batches.glob("fe_*.nc"))
        root = collect(*files, relaxation=[p for p in curves if "methods" not in p.name])
        beside = collect_other_loads(*files, [p for p in curves if "methods" not in p.name])
        beside |= collect_convergence(scene, batches.glob("convergence.nc"))
        beside |= collect_methods(scene, batches.glob("relaxation_methods.nc"))
    return write_dataset(root, folder / "study.nc", beside)


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("results")
    return {name: run(parse_scene(scene), folder / name) for name, scene in EXAMPLES.items()}


ELAPSED = "Coordinate variable 'time' should have standard_name='time', found: 'None'"
"""The checker's one complaint that stays: by that name CF means a date, and the checker refuses
the name for seconds since a step, but it goes by the name of the dimension alone."""


def each_group(group, path="/"):
    """Path and group of a file, the root first."""
    yield path, group
    for name, inner in group.groups.items():
        yield from each_group(inner, f"{path.rstrip('/')}/{name}")


def flattened(root, group, path: Path) -> Path:
    """A group as a file of its own, byte for byte: the checker looks at root groups only."""
    sizes = {}
    above = group
    while above is not None:
        sizes = {name: len(dim) for name, dim in above.dimensions.items()} | sizes
        above = above.parent
    with netCDF4.Dataset(path, "w") as flat:
        own = {name: group.getncattr(name) for name in group.ncattrs()}
        flat.setncatts({name: root.getncattr(name) for name in root.ncattrs()} | own)
        for name, source in group.variables.items():
            for dim in source.dimensions:
                if dim not in flat.dimensions:
                    flat.createDimension(dim, sizes[dim])
            about = {key: source.getncattr(key) for key in source.ncattrs()}
            fill = about.pop("_FillValue", None)
            copy = flat.createVariable(name, source.dtype, source.dimensions, fill_value=fill)
            for end in (source, copy):
                end.set_auto_maskandscale(False)
            copy.setncatts(about)
            copy[...] = source[...]
    return path


def complaints(path: Path, folder: Path) -> list[str]:
    """What the CF checker says to the groups of a file, errors and warnings alike."""
    CheckSuite.load_all_available_checkers()
    standard = f"cf:{CONVENTIONS.removeprefix('CF-')}"
    found = []
    with netCDF4.Dataset(path) as root:
        for name, group in each_group(root):
            if not group.variables:
                continue
            suite = CheckSuite()
            flat = flattened(root, group, folder / f"flat{name.replace('/', '_')}.nc")
            with suite.load_dataset(str(flat)) as loaded:
                results, failures = suite.run_all(loaded, [standard], [])[standard]
            found += [f"{name}: {failure}" for failure in failures]
            found += [
                f"{name}: {message}"
                for result in results
                if isinstance(result.value, tuple) and result.value[0] < result.value[1]
                for message in result.msgs
                if message != ELAPSED
            ]
    return found


def unlisted(path: Path) -> list[str]:
    """Variables of a file that are not in the catalogue as they are."""
    with xr.open_datatree(path) as tree:
        stiffness = tree.ds.get("stiffness")
        axes = () if stiffness is None else tuple(d for d in stiffness.dims if d != "model")
        found = []
        for node in tree.subtree:
            name = "/" if node.path.strip("/") in ("", *STIFFNESS_UNITS) else node.path
            known = [one for group in groups() if group.name == name for one in group.variables]
            for key, variable in node.to_dataset(inherit=False).variables.items():
                about = f"{node.path} {key}{variable.dims} [{variable.attrs.get('units')}]"
                if not any(one.name == key and one.fits(variable, axes) for one in known):
                    found.append(f"{about}: not in the catalogue")
                if not variable.attrs.get("long_name"):
                    found.append(f"{about}: no long_name")
    return found


@pytest.mark.parametrize("name", EXAMPLES)
def test_conventions(files, name, tmp_path):
    assert complaints(files[name], tmp_path) == []


def test_checker_looks_closely(files, tmp_path):
    study = read_dataset(files["sweep"])
    study["stiffness"].attrs["units"] = "bananas"
    spoiled = write_dataset(study, tmp_path / "spoiled.nc")
    assert any("bananas" in text for text in complaints(spoiled, tmp_path))


@pytest.mark.parametrize("name", EXAMPLES)
def test_catalogue(files, name):
    assert unlisted(files[name]) == []


def test_catalogue_notices(files, tmp_path):
    study = read_dataset(files["sweep"]).rename(dof="unknowns")
    study["seconds"].attrs["units"] = "h"
    said = unlisted(write_dataset(study, tmp_path / "other.nc"))
    assert {text.split("(")[0] for text in said} == {"/ seconds", "/ unknowns"}


@pytest.mark.parametrize("name", EXAMPLES)
def test_arrays_are_chunked_compressed_and_checked(files, name):
    with netCDF4.Dataset(files[name]) as root:
        for _, group in each_group(root):
            for variable in group.variables.values():
                if variable.dtype != "S1" and variable.ndim:
                    filters = variable.filters()
                    assert filters["zlib"], variable.name
                    assert filters["fletcher32"], variable.name
                    assert variable.chunking() != "contiguous", variable.name


def test_coordinates_are_finite_or_have_a_companion_that_is(files):
    study = read_dataset(files["sweep"])
    assert np.isinf(study["modulus_ratio"].values[-1])
    companion = study["inverse_modulus_ratio"]
    np.testing.assert_array_equal(companion, [0.1, 0])
    fsi = study["stiffness"].sel(model="fsi")
    drawn = fsi.plot(x="inverse_modulus_ratio", y="gap", add_colorbar=False)
    assert drawn.get_array().size == 4


def test_tree_opens_whole(files):
    with xr.open_datatree(files["sweep"]) as tree:
        assert set(tree.children) == {"bending", "convergence"}
        assert tree["bending"]["stiffness"].attrs["units"] == "N m rad-1"


SHOWN = {
    "design": ("along sample", "points that are no grid"),
    "sweep": ("worst points of", "load bending", "convergence study"),
    "relaxing": ("relaxation of", "constant_bulk", "left at the end"),
    "specimen": ("lattice_paper", "energy"),
}


@pytest.mark.parametrize("name", EXAMPLES)
def test_shown_in_a_terminal(files, name, capsys):
    assert main(["show", str(files[name])]) == 0
    out = capsys.readouterr().out
    assert all(words in out for words in SHOWN[name])


@pytest.mark.slow
@pytest.mark.parametrize("name", ["prony_extreme", "convergence", "specimen"])
def test_scenes_of_the_study(name, tmp_path):
    path = run(load_scene(PARAMS / f"{name}.yaml"), tmp_path)
    assert complaints(path, tmp_path) == []
    assert unlisted(path) == []
    assert path.stat().st_size < 2_000_000
