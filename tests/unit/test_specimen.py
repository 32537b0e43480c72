"""The specimen's lattices and the form of its results; the solid only where it is small."""

import numpy as np
import pytest

from bondcell.errors import InputError
from bondcell.lattice.specimen_geometry import DISPLACEMENT, specimen_packing
from bondcell.specimen.bonds import Material, bond_springs, wall_spring
from bondcell.specimen.bound import softest, softest_lattice
from bondcell.specimen.compare import compare
from bondcell.specimen.full_lattice import FARTHEST, borders
from bondcell.specimen.lattice_variants import specimen_lattice
from bondcell.specimen.paper import printed_stiffness
from bondcell.specimen.solid_half import extrapolate, extrapolate_orders
from bondcell.specimen.specimen import specimen
from bondcell.status import Status

LATTICES = [
    "lattice_paper",
    "lattice_fsi",
    "lattice_fe_normal",
    "lattice_fe_shear",
    "lattice_fe_beam",
]


@pytest.fixture(scope="module")
def lattices():
    return specimen(methods=LATTICES)


def test_paper_s_lattice_has_the_paper_s_counts():
    paper = specimen_lattice("lattice_paper", Material(), "free")
    assert (paper.lattice.count, paper.lattice.bonds.count) == (22, 41)
    free = paper.lattice.count * paper.lattice.width - 2 * paper.fixed.size
    assert free == 22


def test_normal_lattices_differ_by_their_stiffness_only(lattices):
    """Without side springs all share one displacement, and energies go with the stiffness."""
    one, other = (lattices.sel({"method": name, "walls": "free"}) for name in LATTICES[1:3])
    np.testing.assert_allclose(one.displacement, other.displacement, atol=1e-12)
    ratio = 162460.7672 / 84055.1310
    np.testing.assert_allclose(other.energy / one.energy, ratio, rtol=1e-5)


def test_every_added_spring_stiffens(lattices):
    energy = lattices.energy.sel({"method": LATTICES[2:]})
    assert (energy.diff("method") > 0).all()
    assert (energy.sel(walls="fixed") > energy.sel(walls="free")).all()


def test_modes_add_up_and_norms_are_norms(lattices):
    np.testing.assert_allclose(lattices.mode_energy.sum("mode"), lattices.energy, rtol=1e-12)
    norm = np.sqrt((lattices.displacement**2).sum(("particle", "component")))
    np.testing.assert_allclose(lattices.displacement_norm, norm)
    loaded = lattices.displacement.sel(particle=[1, 2, 3], loading="vertical")
    np.testing.assert_allclose(loaded.sel(component="y"), DISPLACEMENT)
    np.testing.assert_allclose(loaded.sel(component="x"), 0, atol=1e-18)
    assert (lattices.status == Status.ok).all()


def test_comparison(lattices):
    errors = compare(lattices, "lattice_fe_beam")
    np.testing.assert_allclose(errors.energy_ratio.sel({"method": "lattice_fe_beam"}), 1)
    np.testing.assert_allclose(errors.displacement_error.sel({"method": "lattice_fe_beam"}), 0)
    assert errors.rotation_error.sel({"method": "lattice_fsi"}).isnull().all()
    assert (errors.rotation_error.sel({"method": "lattice_fe_shear"}) > 0).all()


def test_bending_spring_is_the_cell_s():
    """About the middle of the bond, shear and bending of equal particles do not mix."""
    springs = bond_springs(Material(), "fe")
    assert springs["pivot"] == pytest.approx(0.5, abs=1e-6)
    length = 0.0155
    bending = springs["bending"] + springs["shear"] * length**2 / 4
    assert bending == pytest.approx(2.58039356, rel=1e-6)
    assert springs["torsion"] == pytest.approx(0.52187948, rel=1e-6)


def test_borders_of_the_specimen():
    """Top, both sides; not the bottom, where a wall cuts the spheres."""
    packed = specimen_packing()
    points, pairs = packed.centres[:, :2], packed.neighbours(1e-3)
    numbers, sides, covers = borders(points, pairs)
    assert [tuple(pairs[k] + 1) for k in numbers] == [
        (1, 2), (1, 6), (2, 3), (3, 4), (4, 5), (5, 11), (6, 12), (11, 18),
    ]  # fmt: skip
    middle = points[pairs[numbers]].mean(axis=1)
    along = points[pairs[numbers, 1]] - points[pairs[numbers, 0]]
    outward = sides[:, None] * np.column_stack([-along[:, 1], along[:, 0]])
    assert (outward[[0, 2, 3, 4], 1] > 0).all()
    assert (outward[:, 0] * middle[:, 0] > -1e-12).all()
    top = 36e-3 - points[0, 1]
    assert covers[0] == pytest.approx(top, abs=1e-8)
    assert covers.max() == FARTHEST
    np.testing.assert_array_equal(np.sort(covers[[1, 6]]), np.sort(covers[[5, 7]]))


@pytest.mark.parametrize("distance", [8e-3, 20e-3, 7.4])
def test_wall_spring_is_the_integral(distance):
    from scipy.integrate import quad

    def density(r):
        return 2 * np.pi * r / (distance - np.sqrt(7.5e-3**2 - r**2))

    expected = quad(density, 0, 7.5e-3, epsabs=0, epsrel=1e-11)[0]
    assert wall_spring(1.0, distance) == pytest.approx(expected, rel=1e-7)


def test_printed_pairs_lie_below_what_any_loading_gives():
    paper = specimen_lattice("lattice_paper", Material(), "free")
    assert printed_stiffness("de") < softest_lattice(paper.lattice, paper.fixed) / 3
    assert printed_stiffness("fe") < 39157 / 7


def test_softest_eliminates_what_gives_way():
    matrix = np.array([[2.0, 0.0, 1.0], [0.0, 3.0, 0.0], [1.0, 0.0, 1.0]])
    assert softest(matrix, np.array([True, True, False])) == pytest.approx(1.0)


def test_extrapolation_finds_order_and_limit():
    sizes = [1.0, 0.5, 0.33]
    values = np.array([[1 + 0.1 * h**3, 2 + 0.4 * h**1.5] for h in sizes])
    limit, doubt = extrapolate(sizes, values)
    np.testing.assert_allclose(limit, [1, 2], rtol=1e-9)
    assert ((doubt > 0) & (doubt < 0.1)).all()
    assert np.isnan(extrapolate([1.0], values[:1])[1]).all()


def test_extrapolation_over_orders():
    values = np.array([[1 + 0.2**p, 2 + 3 * 0.5**p] for p in (2, 3, 4)])
    limit, doubt = extrapolate_orders(values)
    np.testing.assert_allclose(limit, [1, 2], rtol=1e-12)
    np.testing.assert_allclose(doubt, values[-1] / [1, 2] - 1)
    two, _ = extrapolate_orders(values[:2])
    assert (two < values[1]).all()
    assert np.isnan(extrapolate_orders(values[:1])[1]).all()


def test_bad_names_and_sizes_are_all_named():
    with pytest.raises(InputError) as caught:
        specimen(methods=["lattice"], loadings=["up"], walls=["glass"], per_gap=[0.5, 1.0])
    fields = [violation.field for violation in caught.value.violations]
    assert fields == ["methods", "loadings", "walls", "per_gap"]
