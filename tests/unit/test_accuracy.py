"""The accuracy table and the ratio from which particles do not matter, known in closed form."""

import numpy as np
import pytest
import xarray as xr

from bondcell.results.accuracy import accuracy_table, signed_error
from bondcell.results.particle_influence import negligible_from, particles_negligible_from
from bondcell.results.view import is_reference, reference_names
from bondcell.status import Status


def rows(table, **wanted):
    for name, value in wanted.items():
        table = table[table[name] == value]
    return table


def test_overall_row(synthetic):
    table = accuracy_table(synthetic.figure4)
    row = rows(table, model="fsi", group_axis="all").iloc[0]
    error = signed_error(synthetic.figure4, "fsi")
    assert row.error_min == pytest.approx(float(error.min()))
    assert row.error_max == pytest.approx(float(error.max()))
    assert row.abs_error_median == pytest.approx(float(np.median(np.abs(error))))
    assert row.abs_error_max == pytest.approx(1 - 1 / 1.94, rel=1e-5)
    assert (row.at_modulus_ratio, row.at_poisson_m) == (1e6, 0.46)
    assert (row.points, row.left_out, row.reference_error) == (50, 0, 1e-7)


def test_small_axes_get_a_row_for_each_value(synthetic):
    table = rows(accuracy_table(synthetic.figure4), model="fsi", group_axis="poisson_m")
    assert table.group_value.tolist() == [0.0, 0.46]
    assert table.points.tolist() == [25, 25]
    assert table.abs_error_max.tolist() == pytest.approx([1 - 1 / 1.04, 1 - 1 / 1.94], rel=1e-4)
    assert set(accuracy_table(synthetic.figure4).group_axis) == {"all", "poisson_m"}


def test_points_without_value_are_counted_by_flag(synthetic):
    row = rows(accuracy_table(synthetic.figure4), model="cementation", group_axis="all").iloc[0]
    assert (row.points, row.left_out) == (25, 25)
    assert row.left_out_by == "diverges: 25 (cementation)"


def test_failed_reference_is_left_out_for_every_model(synthetic):
    study = synthetic.figure4.copy(deep=True)
    study["stiffness"].loc[{"model": "fe", "poisson_m": 0.0}] = np.nan
    study["status"].loc[{"model": "fe", "poisson_m": 0.0}] = Status.solver_failed
    table = accuracy_table(study)
    assert set(rows(table, group_axis="all").points) == {25, 0}
    assert rows(table, model="fsi", group_axis="all").left_out_by.item() == "solver_failed: 25 (fe)"
    empty = rows(table, model="fsi", group_value=0.0).iloc[0]
    assert empty.points == 0
    assert np.isnan(empty.abs_error_max)
    assert np.isnan(empty.at_modulus_ratio)


def test_a_stale_number_behind_a_failure_flag_is_not_compared(synthetic):
    study = synthetic.figure4.copy(deep=True)
    study["status"].loc[{"model": "fsi", "poisson_m": 0.46}] = Status.limit_exceeded
    assert rows(accuracy_table(study), model="fsi", group_axis="all").points.item() == 25


def test_points_outside_the_valid_range_are_compared_and_told_apart(synthetic):
    study = synthetic.figure4.copy(deep=True)
    study["status"].loc[{"model": "fsi", "poisson_m": 0.46}] = Status.outside_valid_range
    row = rows(accuracy_table(study), model="fsi", group_axis="all").iloc[0]
    assert (row.points, row.points_outside) == (50, 25)
    assert row.abs_error_max > 0.4
    assert row.abs_error_max_inside < 0.05


def test_every_reference_is_compared_with(synthetic):
    study = synthetic.figure4
    clamped = study.sel(model=["fe"]).assign_coords(model=["fe_clamped"])
    clamped["stiffness"] = clamped.stiffness * 2
    both = xr.concat([study, clamped], dim="model", data_vars="minimal")
    assert reference_names(both) == ["fe", "fe_clamped"]
    table = rows(accuracy_table(both), group_axis="all")
    assert len(table) == 2 * 6
    assert "fe" not in set(table.model)


def test_single_point(synthetic):
    table = accuracy_table(synthetic.point)
    assert len(table) == 6
    assert table.points.tolist() == [1, 1, 1, 1, 1, 0]


@pytest.mark.parametrize("study", [xr.Dataset(), None])
def test_without_reference_the_table_is_empty(study, synthetic):
    study = synthetic.figure4.sel(model=["fsi", "slices"]) if study is None else study
    table = accuracy_table(study)
    assert table.empty
    assert "abs_error_max" in table.columns


def test_table_survives_the_csv(synthetic, tmp_path):
    import pandas as pd

    table = accuracy_table(synthetic.figure4)
    table.to_csv(tmp_path / "accuracy.csv", index=False)
    back = pd.read_csv(tmp_path / "accuracy.csv", keep_default_na=True)
    assert back.columns.tolist() == table.columns.tolist()
    assert back.abs_error_max.tolist() == pytest.approx(table.abs_error_max.tolist(), nan_ok=True)


def test_names_of_references():
    assert [is_reference(name) for name in ("fe", "fe_clamped", "fem_like", "fsi")] == [
        True,
        True,
        False,
        False,
    ]


def test_ratio_from_which_particles_do_not_matter(synthetic):
    """FSI: 1 - K/k_int = c/(1 + c) with c = 2 k_int/k_i, so the answer is known."""
    table = particles_negligible_from(synthetic.figure4)
    study = synthetic.figure4.isel(poisson_m=0)
    share = float((2 * study.k_int / study.k_i * study.modulus_ratio)[0])
    fsi = rows(table, method="fsi")
    assert fsi.ratio_from.tolist() == pytest.approx([99 * share] * 2, rel=2e-3)
    assert fsi.deviation_at_paper_ratio.tolist() == pytest.approx(
        [share / (12 + share)] * 2, rel=1e-9
    )
    fe = rows(table, method="fe")
    assert fe.ratio_from.tolist() == pytest.approx([99 * share * 1.04, 99 * share * 1.94], rel=5e-3)


def test_too_short_a_sweep_does_not_show_the_limit(synthetic):
    short = synthetic.figure4.sel(modulus_ratio=slice(1, 100.1))
    table = particles_negligible_from(short)
    assert table.ratio_from.isna().all()


def test_no_modulus_axis_no_answer(synthetic):
    assert particles_negligible_from(synthetic.point).empty


def test_negligible_from_edges():
    ratio = np.array([1.0, 10.0, 100.0])
    assert negligible_from(ratio, np.array([0.001, 1e-4, 0.0]), 0.01) == 1.0
    assert np.isnan(negligible_from(ratio, np.array([1.0, 0.5, 0.1]), 0.01))
    assert np.isnan(negligible_from(ratio, np.full(3, np.nan), 0.01))
    back = np.array([0.001, 0.1, 0.001])
    assert negligible_from(ratio, back, 0.01) == pytest.approx(10**1.5)


def test_two_ratios_far_apart_show_nothing():
    """Neither across decades nor to the point that is itself the limit is anything interpolated."""
    assert np.isnan(negligible_from(np.array([10.0, 1e4]), np.array([0.2, 2e-4]), 0.01))
    assert np.isnan(negligible_from(np.array([10.0, 50.0]), np.array([0.2, 0.0]), 0.01))
