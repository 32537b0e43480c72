import warnings
from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bondcell.cell import Cell, FloatArray
from bondcell.errors import BondcellError, InputError
from bondcell.models import MODELS
from bondcell.models.model import Springs

Test = TypeVar("Test", bound=Callable[..., None])

BASE = {
    "radius_i": 7.5e-3,
    "gap": 5e-4,
    "young_i": 3e10,
    "young_m": 1.4e6,
    "poisson_i": 0.25,
    "poisson_m": 0.46,
}
# The surrogate is data, the film model a minimum over fields: both have tests of their own.
ANALYTIC = tuple(name for name in MODELS if name not in ("fe", "surrogate", "film", "bounds"))
NETWORKS = ("fsi", "general", "generatrix", "slices")
"""Models that are networks of springs, each proportional to one modulus."""


def springs(model: str, cell: Cell, **options: object) -> Springs:
    return MODELS[model].loads["normal"](cell, **options)


def stiffness(model: str, cell: Cell, **options: object) -> FloatArray:
    return springs(model, cell, **options).stiffness


def cell_of(**changes: object) -> Cell:
    return Cell.from_values(**{**BASE, **changes})


def for_all(*strategies: st.SearchStrategy[Any]) -> Callable[[Test], Test]:
    """A law checked at random examples; no deadline, since machines are shared."""
    return lambda test: settings(max_examples=25, deadline=None)(given(*strategies)(test))


def logs(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(low, high).map(lambda exponent: 10.0**exponent)


@st.composite
def cells(draw: st.DrawFn, equal: bool = False, wide: bool = True) -> Cell:
    """One cell anywhere in the supported range, rigid particles and homogeneous cells included."""
    modulus = st.one_of(logs(-12, 12), st.sampled_from([1.0, np.inf]))
    ratio = st.one_of(logs(-3, 3), st.floats(0, 1e-9).map(lambda small: 1 + small))
    radius_i, radius_j = 1.0, 1.0 if equal else draw(ratio)
    outer = max(radius_i, radius_j) * (draw(st.sampled_from([1.0, 1.2, 50.0])) if wide else 1.0)
    return Cell.from_values(
        radius_i=radius_i,
        radius_j=radius_j,
        gap=draw(logs(-12, 6)),
        cylinder_radius=outer,
        young_i=draw(modulus),
        young_j=draw(modulus),
        young_m=1.0,
        poisson_i=draw(st.floats(-0.9, 0.5)),
        poisson_j=draw(st.floats(-0.9, 0.5)),
        poisson_m=draw(st.floats(-0.9, 0.49)),
    )


def changed(cell: Cell, **changes: FloatArray) -> Cell:
    return Cell.from_values(**{**cell.as_dict(), **changes})


class TestCheckValues:
    """Rounded values of theory.md, section 2."""

    def test_fsi_interface(self) -> None:
        k_int = springs("fsi", cell_of(gap=[5e-4, 1e-6, 0.1])).parts["k_int"]
        assert k_int == pytest.approx([84065.1275, 284230.5331, 2358.8220], rel=5e-10, abs=5e-5)

    @pytest.mark.parametrize(
        ("model", "expected"),
        [
            ("generatrix", [49518.7428, 84026.8218]),
            ("fsi", [66992.4209, 84055.1310]),
            ("slices", [73299.131, 490897.56]),
        ],
    )
    def test_soft_and_stiff_particles(self, model: str, expected: list[float]) -> None:
        digits = 5e-3 if model == "slices" else 5e-5
        value = stiffness(model, cell_of(young_i=[1.4e7, 3e10]))
        assert value == pytest.approx(expected, rel=0, abs=digits)

    def test_half_the_gap_gives_the_stiffness_the_paper_states(self) -> None:
        """1.05e5 N/m; the 104 878 of the check value is the interface spring, not K_n."""
        answer = springs("fsi", cell_of(gap=2.5e-4))
        assert answer.parts["k_int"] == pytest.approx(104_878, abs=0.5)
        assert answer.stiffness == pytest.approx(104_862, abs=0.5)


class TestStructure:
    def test_names(self) -> None:
        expected = (
            *NETWORKS,
            "parallel_bond",
            "cementation",
            "film",
            "bounds",
            "surrogate",
            "fe",
        )
        assert tuple(MODELS) == expected
        for name, model in MODELS.items():
            assert model.name == name
            assert all((model.title, model.summary, model.source, model.valid_range))
            assert "normal" in model.loads
        assert [name for name, model in MODELS.items() if model.is_reference] == ["fe"]

    def test_the_registry_cannot_be_changed(self) -> None:
        with pytest.raises(TypeError):
            MODELS["mine"] = MODELS["fsi"]  # type: ignore[index]

    def test_the_reference_has_no_direct_call(self) -> None:
        with pytest.raises(BondcellError, match=r"bondcell\.evaluate"):
            stiffness("fe", cell_of())

    @pytest.mark.parametrize("model", ANALYTIC)
    def test_broadcast_shape(self, model: str) -> None:
        grid = cell_of(
            gap=np.array([1e-4, 1e-3]).reshape(2, 1, 1, 1),
            young_m=np.array([1e6, 1e7, 1e9]).reshape(3, 1, 1),
            poisson_m=np.array([0.0, 0.3]).reshape(2, 1),
            radius_j=np.array([7.5e-3, 5e-3, 1e-2]),
        )
        whole = springs(model, grid)
        assert whole.stiffness.shape == grid.shape == (2, 3, 2, 3)
        assert all(part.shape == grid.shape for part in whole.parts.values())
        assert MODELS[model].is_valid(grid).shape == grid.shape
        assert np.all(np.asarray(whole.relative_error) > 0)
        flat = grid.ravel()
        for index in (0, 7, 17, 35):
            alone = stiffness(model, flat.take(index))
            assert alone == pytest.approx(whole.stiffness.ravel()[index], rel=1e-13)

    @pytest.mark.parametrize("model", ANALYTIC)
    def test_scalar_cell(self, model: str) -> None:
        assert stiffness(model, cell_of()).shape == ()

    def test_parts(self) -> None:
        expected = {
            "fsi": ("k_i", "k_int", "k_j"),
            "general": ("k_i", "k_lr", "k_j", "k_par"),
            "generatrix": (),
            "slices": ("k_i", "k_int", "k_j"),
            "parallel_bond": (),
            "cementation": (),
        }
        cell = cell_of(radius_j=5e-3, young_j=1e9, cylinder_radius=1e-2)
        for model, names in expected.items():
            assert tuple(springs(model, cell).parts) == names

    @pytest.mark.parametrize(
        ("model", "option"),
        [
            ("general", "core_radius_ratio"),
            ("parallel_bond", "bond_radius_ratio"),
            ("cementation", "cement_radius_ratio"),
        ],
    )
    def test_options(self, model: str, option: str) -> None:
        assert tuple(MODELS[model].options) == (option,)
        assert np.isfinite(stiffness(model, cell_of(), **{option: 0.5}))
        assert np.isfinite(stiffness(model, cell_of(), **{option: 1}))
        for bad in (0.0, -1.0, 1.1, np.nan, "half", True, [0.5]):
            with pytest.raises(InputError) as caught:
                stiffness(model, cell_of(), **{option: bad})
            assert caught.value.violations[0].field == option


class TestParts:
    @for_all(cells())
    def test_series_of_fsi_and_slices(self, cell: Cell) -> None:
        for model in ("fsi", "slices"):
            answer = springs(model, cell)
            total = 1 / sum(1 / part for part in answer.parts.values())
            assert answer.stiffness == pytest.approx(total, rel=1e-13)

    @for_all(cells())
    def test_core_and_bond_of_general(self, cell: Cell) -> None:
        answer = springs("general", cell)
        core = 1 / sum(1 / answer.parts[name] for name in ("k_i", "k_lr", "k_j"))
        assert answer.stiffness == pytest.approx(core + answer.parts["k_par"], rel=1e-13)

    def test_particle_springs_of_fsi_know_their_own_particle_only(self) -> None:
        cell = cell_of(radius_j=[5e-3, 1e-3], young_j=1e9, cylinder_radius=1e-2)
        parts = springs("fsi", cell).parts
        assert parts["k_i"] == pytest.approx(2 * np.pi * 3e10 * 7.5e-3)
        assert parts["k_j"] == pytest.approx(2 * np.pi * 1e9 * np.array([5e-3, 1e-3]))

    def test_a_full_core_leaves_no_bond(self) -> None:
        parts = springs("general", cell_of(), core_radius_ratio=1.0).parts
        assert parts["k_par"] == 0.0
        assert parts["k_i"] == pytest.approx(springs("fsi", cell_of()).parts["k_i"], rel=1e-15)
        assert parts["k_lr"] == pytest.approx(np.pi * 1.4e6 * 7.5e-3**2 / 5e-4)

    def test_a_vanishing_core_leaves_the_generatrix_lines(self) -> None:
        value = stiffness("general", cell_of(), core_radius_ratio=1e-6)
        assert value == pytest.approx(stiffness("generatrix", cell_of()), rel=1e-10)


class TestLaws:
    @for_all(cells(), st.integers(-20, 20), st.integers(-40, 40))
    def test_dimensions(self, cell: Cell, length: int, modulus: int) -> None:
        """Powers of two, which round nothing."""
        lengths = ("radius_i", "radius_j", "gap", "cylinder_radius")
        scaled = {
            name: np.ldexp(value, length if name in lengths else modulus if "young" in name else 0)
            for name, value in cell.as_dict().items()
        }
        for model in ANALYTIC:
            expected = np.ldexp(stiffness(model, cell), length + modulus)
            assert stiffness(model, Cell.from_values(**scaled)) == pytest.approx(
                expected, rel=1e-13
            )

    @for_all(cells())
    def test_swapping_the_particles(self, cell: Cell) -> None:
        swapped = cell.swapped()
        for model in ANALYTIC:
            expected = stiffness(model, cell)
            assert stiffness(model, swapped) == pytest.approx(expected, rel=1e-13)
        parts, other = springs("fsi", cell).parts, springs("fsi", swapped).parts
        assert parts["k_i"] == other["k_j"]
        assert parts["k_int"] == other["k_int"]

    @for_all(
        cells(),
        st.sampled_from(["young_i", "young_j", "young_m"]),
        st.one_of(logs(-9, 0), logs(0, 6)).map(lambda rise: 1 + rise),
    )
    def test_stiffer_material_stiffens(self, cell: Cell, name: str, factor: float) -> None:
        stiffer = changed(cell, **{name: getattr(cell, name) * factor})
        for model in (*NETWORKS, "parallel_bond", "cementation"):
            tolerance = 1e-3 if model == "cementation" else 1e-13
            assert stiffness(model, stiffer) >= stiffness(model, cell) * (1 - tolerance)

    @for_all(cells(), logs(-3, 3))
    def test_wider_gap_softens(self, cell: Cell, rise: float) -> None:
        wider = changed(cell, gap=cell.gap * (1 + rise))
        for model in ("fsi", "generatrix", "slices"):
            assert stiffness(model, wider) <= stiffness(model, cell) * (1 + 1e-13)
        ratio = {"core_radius_ratio": 0.4}
        narrow, wide = (stiffness("general", one, **ratio) for one in (cell, wider))
        assert wide <= narrow * (1 + 1e-13)

    @for_all(cells(), logs(-6, 3))
    def test_wider_cylinder_stiffens(self, cell: Cell, rise: float) -> None:
        wider = changed(cell, cylinder_radius=cell.cylinder_radius * (1 + rise))
        for model in NETWORKS:
            assert stiffness(model, wider) >= stiffness(model, cell) * (1 - 1e-13)


class TestBounds:
    """Rayleigh: tying nodes of a network together stiffens it."""

    @for_all(cells())
    def test_generatrix_is_softer_than_slices(self, cell: Cell) -> None:
        assert stiffness("generatrix", cell) <= stiffness("slices", cell) * (1 + 1e-13)

    @for_all(cells(equal=True, wide=False))
    def test_generatrix_is_softer_than_fsi_if_every_line_crosses_both(self, cell: Cell) -> None:
        assert stiffness("generatrix", cell) <= stiffness("fsi", cell) * (1 + 1e-13)

    def test_fsi_hangs_a_wide_cylinder_behind_its_particles(self) -> None:
        """Why the last bound asks for R_c = R: FSI never exceeds k_i, the lines do."""
        cell = cell_of(young_m=1e10, cylinder_radius=1.0)
        assert stiffness("fsi", cell) < springs("fsi", cell).parts["k_i"]
        assert stiffness("generatrix", cell) > 100 * stiffness("fsi", cell)

    @for_all(cells(), st.one_of(st.none(), st.floats(1e-3, 1)))
    def test_generatrix_is_softer_than_general(self, cell: Cell, ratio: float | None) -> None:
        general = stiffness("general", cell, core_radius_ratio=ratio)
        assert stiffness("generatrix", cell) <= general * (1 + 1e-13)

    @for_all(cells())
    def test_between_homogeneous_cylinders(self, cell: Cell) -> None:
        bar = np.pi * cell.cylinder_radius**2 / cell.length
        moduli = [float(getattr(cell, name)) for name in ("young_i", "young_j", "young_m")]
        for model in ("generatrix", "slices"):
            value = stiffness(model, cell)
            assert min(moduli) * bar * (1 - 1e-13) <= value <= max(moduli) * bar * (1 + 1e-13)


class TestLimits:
    @for_all(cells())
    def test_homogeneous_cylinder(self, cell: Cell) -> None:
        same = changed(cell, young_i=cell.young_m, young_j=cell.young_m)
        bar = np.pi * same.young_m * same.cylinder_radius**2
        exact = bar / (same.radius_i + same.radius_j + same.gap)
        assert stiffness("slices", same) == exact
        assert stiffness("generatrix", same) == pytest.approx(exact, rel=1e-14)

    @for_all(cells(), st.floats(-15, -2), st.sampled_from([-1, 1]))
    def test_slices_pass_smoothly_through_homogeneity(
        self, cell: Cell, exponent: float, sign: int
    ) -> None:
        """Compliance to second order in the contrast; the arc tangents of both kinds join."""
        epsilon = sign * 10.0**exponent
        near = changed(cell, young_i=1 + epsilon, young_j=np.asarray(1.0), young_m=np.asarray(1.0))
        contrast = float(near.young_i) - 1.0
        radius, outer = float(cell.radius_i), float(cell.cylinder_radius)
        first = contrast * 2 / 3 * radius**3 / outer**2
        second = contrast**2 * 8 / 15 * radius**5 / outer**4
        length = float(cell.length) - first + second
        expected = np.pi * outer**2 / length
        assert stiffness("slices", near) == pytest.approx(
            expected, rel=1e-13 + abs(contrast) ** 3 * radius**7 / outer**6 / length
        )

    @pytest.mark.parametrize("radius_j", [7.5e-3, 5e-3])
    def test_rigid_particles(self, radius_j: float) -> None:
        cell = cell_of(young_i=np.inf, radius_j=radius_j)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            answers = {model: springs(model, cell) for model in ANALYTIC}
        fsi, slices, general = (answers[model] for model in ("fsi", "slices", "general"))
        assert np.isinf(fsi.parts["k_i"])
        assert fsi.stiffness == pytest.approx(fsi.parts["k_int"], rel=1e-15)
        assert answers["generatrix"].stiffness == pytest.approx(fsi.stiffness, rel=1e-14)
        assert np.isinf(slices.parts["k_j"])
        assert slices.stiffness == slices.parts["k_int"]
        assert general.stiffness == pytest.approx(general.parts["k_lr"] + general.parts["k_par"])
        for answer in answers.values():
            assert np.isfinite(answer.stiffness)

    @for_all(cells())
    def test_rigid_is_the_limit_of_stiff(self, cell: Cell) -> None:
        rigid = changed(cell, young_i=np.asarray(np.inf), young_j=np.asarray(np.inf))
        stiff = changed(cell, young_i=np.asarray(1e40), young_j=np.asarray(1e40))
        for model in ANALYTIC:
            expected = stiffness(model, rigid)
            assert stiffness(model, stiff) == pytest.approx(expected, rel=1e-12)

    def test_one_rigid_particle(self) -> None:
        cell = cell_of(young_i=np.inf, young_j=1e6, radius_j=5e-3)
        for model in ANALYTIC:
            near = stiffness(model, cell_of(young_i=1e40, young_j=1e6, radius_j=5e-3))
            assert stiffness(model, cell) == pytest.approx(near, rel=1e-12)

    @for_all(cells(), logs(-15, -7))
    def test_continuous_where_radii_become_equal(self, cell: Cell, offset: float) -> None:
        """Equal spheres have a formula of their own; the others must arrive there."""
        equal = changed(cell, radius_j=cell.radius_i, cylinder_radius=np.asarray(1e3))
        near = changed(equal, radius_j=equal.radius_i * (1 - offset))
        moved = offset / float(min(cell.gap, 1.0)) * 10 + 1e-13
        for model in NETWORKS:
            if moved < 1e-2:
                expected = stiffness(model, equal)
                assert stiffness(model, near) == pytest.approx(expected, rel=moved)

    def test_wide_cylinders_become_bars_of_matrix(self) -> None:
        cell = cell_of(cylinder_radius=1e3)
        bar = np.pi * 1.4e6 * 1e3**2 / cell.length
        for model in ("generatrix", "general", "slices"):
            assert stiffness(model, cell) == pytest.approx(bar, rel=1e-2)
        assert springs("fsi", cell).parts["k_int"] == pytest.approx(bar, rel=1e-6)


class TestValidRange:
    def test_series_models_claim_a_weak_matrix(self) -> None:
        cell = cell_of(young_m=[1.4e6, 3e10, 3.1e10])
        for model in ("fsi", "general"):
            assert MODELS[model].is_valid(cell).tolist() == [True, True, False]
        either = cell_of(young_m=1e9, young_j=[1e8, 1e10])
        assert MODELS["fsi"].is_valid(either).tolist() == [False, True]

    def test_bounds_hold_everywhere(self) -> None:
        cell = cell_of(young_m=[1.0, 1e15], gap=[[1e-9], [1e3]])
        for model in ("generatrix", "slices", "fe"):
            assert MODELS[model].is_valid(cell).all()

    def test_parallel_bond_wants_near_contact(self) -> None:
        valid = MODELS["parallel_bond"].is_valid(cell_of(gap=[1.4e-3, 1.6e-3]))
        assert valid.tolist() == [True, False]

    def test_cementation_wants_thin_compressible_soft_cement(self) -> None:
        is_valid = MODELS["cementation"].is_valid
        assert is_valid(cell_of(poisson_m=[0.0, 0.3, 0.31])).tolist() == [True, True, False]
        assert is_valid(cell_of(poisson_m=0.2, gap=[7e-4, 8e-4])).tolist() == [True, False]
        assert is_valid(cell_of(poisson_m=0.2, young_m=[2e9, 4e9])).tolist() == [True, False]


class TestComparators:
    def test_parallel_bond(self) -> None:
        cell = cell_of(radius_j=5e-3, gap=[1e-6, 1e-3])
        expected = np.pi * (0.8 * 5e-3) ** 2 * 1.4e6 / 12.5e-3
        value = stiffness("parallel_bond", cell, bond_radius_ratio=0.8)
        assert value == pytest.approx([expected, expected], rel=1e-14)

    def test_cementation_of_rigid_unequal_grains(self) -> None:
        cell = cell_of(young_i=np.inf, radius_j=5e-3, poisson_m=0.3)
        modulus = 1.4e6 * 0.7 / (1.3 * 0.4)
        curvature = 3e-3
        expected = 2 * np.pi * curvature * modulus * np.log1p(4e-3**2 / (2 * curvature * 5e-4))
        value = stiffness("cementation", cell, cement_radius_ratio=0.8)
        assert value == pytest.approx(expected, rel=2e-4)

    def test_cementation_diverges_for_incompressible_cement(self) -> None:
        poisson = [0.46, 0.4999, 0.49999, 0.5]
        value = stiffness("cementation", cell_of(young_i=np.inf, poisson_m=poisson))
        assert value[2] > 9.9 * value[1] > 99 * value[0]
        assert np.isinf(value[3])
        elastic = stiffness("cementation", cell_of(poisson_m=poisson))
        assert np.isfinite(elastic).tolist() == [True, True, True, False]
