"""Results of the specimen's jobs put together; the solid's are made up."""

import numpy as np
import pytest

from bondcell.report.specimen_part import specimen_part
from bondcell.scenes.parsing import parse_scene
from bondcell.specimen.names import METHODS
from bondcell.specimen.results import combine
from bondcell.specimen.run import run_part
from bondcell.specimen.view import error_table
from bondcell.status import Status

LATTICES = ["lattice_paper", "lattice_fsi"]
LIMIT = np.array([0.026, 0.058])
"""Made-up energies without discretisation error [J], by loading."""


@pytest.fixture(scope="module")
def lattices():
    scene = parse_scene({"title": "Lattices", "specimen": {"lattices": LATTICES}})
    return run_part(scene, "lattices")[0]


def solid(lattices, method, sizes, walls):
    """A solid whose energies go up with the square of the size, and whose particles move alike."""
    one = lattices.sel({"method": ["lattice_fsi"], "walls": walls}).drop_vars(
        ["bond_force", "bond_nodes", "force", "mode_energy", "mode"]
    )
    one = one.assign_coords(method=[method], per_gap=list(sizes), order=[2])
    wide = np.ones((1, 2, len(walls), len(sizes), 1))
    levels = (LIMIT[:, None, None] * (1 + 0.1 * np.square(sizes)))[..., None] * wide
    dims = ("method", "loading", "walls", "per_gap", "order")
    one["level_energy"] = (dims, levels, {"units": "J", "long_name": "energy"})
    one["level_dof"] = (dims, 1e5 * wide, {"units": "1", "long_name": "unknowns"})
    one["level_seconds"] = (dims, wide, {"units": "s", "long_name": "time"})
    one["energy"] = (dims[:3], levels[..., -1, 0], {"units": "J", "long_name": "energy"})
    ladder = len(sizes) > 1
    limit = LIMIT[:, None] if ladder else levels[0, ..., -1, 0]
    one["limit_energy"] = (dims[:3], limit * wide[..., 0, 0], {"units": "J", "long_name": "limit"})
    doubt = 0.05 * min(sizes) ** 2 if ladder else np.nan
    about = {"units": "1", "long_name": "error"}
    one["limit_error"] = (dims[:3], doubt * wide[..., 0, 0], about)
    one["error_estimate"] = one["energy"] / one["limit_energy"] - 1 + one["limit_error"]
    one["error_estimate"].attrs = about
    return one


def test_ladder_of_one_solid_serves_the_other_on_the_same_mesh(lattices):
    parts = {
        "lattices": lattices,
        "fe_rigid": solid(lattices, "fe_rigid", (1.0, 0.5), ["free"]),
        "fe_elastic": solid(lattices, "fe_elastic", (0.5,), ["free", "fixed"]),
    }
    root, groups = combine(parts)
    assert root["method"].values.tolist() == [m for m in METHODS if m in root["method"].values]
    np.testing.assert_allclose(root["reference_energy"], np.stack([LIMIT, LIMIT], axis=1))
    np.testing.assert_allclose(root["reference_error"], 0.05 * 0.25, rtol=1e-9)
    ratio = root["energy_ratio"].sel({"method": "fe_elastic"})
    np.testing.assert_allclose(ratio, 1 + 0.1 * 0.25)
    assert root["displacement_error"].sel({"method": "fe_elastic"}).max() == 0
    assert groups["ladder"]["per_gap"].values.tolist() == [1.0, 0.5]
    table = error_table({"": root, **groups})
    assert set(table["method"]) == {"fe_rigid", "fe_elastic", *LATTICES}


def test_missing_combinations_are_flagged(lattices):
    parts = {"lattices": lattices, "fe_rigid": solid(lattices, "fe_rigid", (1.0,), ["free"])}
    root, _ = combine(parts)
    fixed = root.sel({"method": "fe_rigid", "walls": "fixed"})
    assert (fixed["status"] == Status.not_computed).all()
    assert fixed["energy"].isnull().all()
    assert fixed["energy_ratio"].isnull().all()
    assert root["reference_error"].isnull().all()


def test_page_does_not_claim_what_the_meshes_cannot_say(lattices):
    def said(*sizes):
        parts = {"lattices": lattices, "fe_rigid": solid(lattices, "fe_rigid", sizes, ["free"])}
        root, groups = combine(parts)
        findings, tables = specimen_part({"": root, **groups})
        assert any("prints" in table.caption for table in tables)
        return " ".join(finding.text for finding in findings)

    assert "beyond 2 %" in said(1.0, 0.5)
    assert "one mesh does not say" in said(1.0)


def test_lattices_alone_have_a_page(lattices):
    root, groups = combine({"lattices": lattices})
    findings, tables = specimen_part({"": root, **groups})
    text = " ".join(finding.text for finding in findings)
    assert "nothing to compare" in text
    assert "3.7 times" in text
    assert tables
