"""Tables in and out: the two common conventions, errors by line, few terms, the bond's table."""

import csv

import numpy as np
import pytest
import xarray as xr

import bondcell
from bondcell import Prony, PronyError
from bondcell.prony.chain import Chain
from bondcell.prony.reduction import reduce_chain

PAIRED = "# asphalt\ng,k,tau\n0.3,0.1,1e-3\n0.2,0,1\n"
SPLIT = "table,weight,tau\nshear,0.3,1e-3\nshear,0.2,1\nbulk,0.1,1e-3\n"
YAML = "relative_to: instantaneous\nshear: [[0.3, 1e-3], [0.2, 1]]\nbulk: [[0.1, 1e-3]]\n"
LISTS = "g: [0.3, 0.2]\nk: [0.1, 0]\ntau: [1e-3, 1]\n"


def written(folder, name, text):
    path = folder / name
    path.write_text(text)
    return path


@pytest.mark.parametrize(
    ("name", "text"),
    [("a.csv", PAIRED), ("b.csv", SPLIT), ("c.yaml", YAML), ("d.yml", LISTS)],
)
def test_every_form_reads_the_same(tmp_path, name, text):
    prony = bondcell.read_prony(written(tmp_path, name, text))
    np.testing.assert_array_equal(prony.shear.strengths, [0.3, 0.2])
    np.testing.assert_array_equal(prony.shear.times, [1e-3, 1.0])
    assert prony.bulk is not None
    np.testing.assert_array_equal(prony.bulk.strengths, [0.1])
    np.testing.assert_array_equal(prony.bulk.times, [1e-3])


def test_a_bulk_modulus_that_does_not_relax_is_none(tmp_path):
    assert bondcell.read_prony(written(tmp_path, "a.csv", "g,k,tau\n0.3,0,1\n")).bulk is None
    assert bondcell.read_prony(written(tmp_path, "b.csv", "g,tau\n0.3,1\n")).bulk is None


def test_absolute_moduli_from_yaml(tmp_path):
    text = "relative_to: absolute\nlong_term: 1e6\nmodulus: young\nshear: [[3e6, 1.0]]\n"
    prony = bondcell.read_prony(written(tmp_path, "a.yaml", text))
    assert prony.instantaneous_modulus == 4e6


def test_errors_name_the_line(tmp_path):
    path = written(tmp_path, "a.csv", "g,k,tau\n0.3,0.1,1\nhalf,0.1,0\n0.2,1\n-1,0,2\n")
    with pytest.raises(PronyError) as caught:
        bondcell.read_prony(path)
    fields = [violation.field for violation in caught.value.violations]
    assert fields == ["line 3, g", "line 3, tau", "line 4", "line 5, g"]
    assert "a.csv" in str(caught.value)


@pytest.mark.parametrize(
    ("name", "text", "field"),
    [
        ("a.csv", "tau,g\n1,0.3\n", "header"),
        ("a.csv", "", "header"),
        ("a.csv", "table,weight,tau\nshare,0.1,1\n", "line 2, table"),
        ("a.csv", "g,tau\n0.7,1\n0.6,2\n", "sum of weights"),
        ("a.yaml", "shear: 0.3\n", "shear"),
        ("a.yaml", "g: [0.1]\ntau: [1, 2]\n", "g, k, tau"),
        ("a.yaml", "shear: [[0.1, 1]]\nsheer: 1\n", "sheer"),
        ("a.txt", "", "file"),
    ],
)
def test_each_slip_of_a_file(tmp_path, name, text, field):
    with pytest.raises(PronyError) as caught:
        bondcell.read_prony(written(tmp_path, name, text))
    assert [violation.field for violation in caught.value.violations] == [field]


def test_missing_file():
    with pytest.raises(PronyError, match="file"):
        bondcell.read_prony("nowhere.csv")


def series():
    study = xr.Dataset(
        {
            "radius_i": 7.5e-3,
            "young_i": 3e10,
            "poisson_i": 0.25,
            "young_m": 1.4e6,
            "poisson_m": 0.46,
        },
        coords={"gap": [1e-4, 5e-4]},
    )
    return bondcell.relaxation_series(study, Prony([0.3, 0.3, 0.3], [1e-3, 1.0, 1e3]), "generatrix")


def test_reduced_series_keeps_its_stated_error():
    full, window = series(), (1e-4, 1e4)
    few = bondcell.reduce_series(full, 3, window)
    assert few.sizes["term"] == 3 < full.sizes["term"]
    t = xr.DataArray(np.geomspace(*window, 777), dims="time")

    def curve(own):
        return own.K_inf + (own.K_k * np.exp(-t / own.tau_k)).sum("term")

    error = np.abs(curve(few) / curve(full) - 1).max("time")
    assert (error <= 1.01 * few.reduction_error + 1e-12).all()
    assert (few.reduction_error < 1e-2).all()
    assert (few.error_estimate >= few.reduction_error).all()
    more = bondcell.reduce_series(full, 500, window)
    np.testing.assert_array_equal(more.reduction_error, 0.0)


def test_reduction_converges():
    chain = Chain(np.array(0.05), np.full(40, 1.0), np.geomspace(1e-4, 1e4, 40))
    errors = [reduce_chain(chain, n, (1e-3, 1e3))[1] for n in (2, 4, 8)]
    assert errors[0] > 3 * errors[1] > 9 * errors[2]
    with pytest.raises(bondcell.InputError, match=r"terms.*\n.*window"):
        reduce_chain(chain, 0, (1.0, 0.5))


ASPHALT = [0.31288, 0.20212, 0.21377, 0.14498, 0.06803, 0.02679, 0.01078, 0.00428, 0.00264]


@pytest.mark.parametrize("count", [2, 4, 6])
def test_few_terms_are_the_best_there_are(count):
    """The error of the best sum alternates at 2 n + 1 times, which no other sum's does."""
    chain = Chain(np.array(1 - sum(ASPHALT)), np.array(ASPHALT), 10.0 ** np.arange(-5, 4))
    window = (1e-6, 1e6)
    few, error = reduce_chain(chain, count, window)
    assert few.count == count
    t = np.geomspace(*window, 3000)
    misfit = few.relaxation(t) / chain.relaxation(t) - 1
    assert np.abs(misfit).max() == pytest.approx(error, rel=1e-3)
    reached = np.sign(misfit[np.abs(misfit) > 0.9 * error])
    assert 1 + np.count_nonzero(np.diff(reached)) == 2 * count + 1
    assert few.equilibrium == chain.equilibrium


def test_as_few_terms_as_an_error_takes():
    full, window = series(), (1e-4, 1e4)
    few = bondcell.reduce_series(full, window=window, error=1e-3)
    assert (few.reduction_error <= 1e-3).all()
    fewer = bondcell.reduce_series(full, few.sizes["term"] - 1, window)
    assert (fewer.reduction_error > 1e-3).any()
    assert few.sizes["term"] < full.sizes["term"]
    exact = bondcell.reduce_series(full, window=window, error=1e-14)
    np.testing.assert_array_equal(exact.K_k, full.K_k)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"terms": 2}, "window = None"),
        ({"window": (1.0, 2.0)}, "terms = None: .* a number of terms or an error"),
        ({"terms": 2, "error": 0.1, "window": (1.0, 2.0)}, "either a number of terms or an error"),
        ({"error": 0, "window": (1.0, 2.0)}, r"error = 0.*\(0, 1\)"),
        ({"error": "1 %", "window": ("a", 2.0)}, r"error = '1 %'.*\n.*window"),
        ({"terms": 2.5, "window": 3.0}, r"terms = 2.5.*\n.*window"),
        ({"terms": 2, "window": (1.0, np.inf)}, "window"),
        ({"terms": 1, "window": (1e-300, 1e300)}, r"window = .*\[1e-30, 1e\+30\]"),
    ],
)
def test_wrong_reductions_are_refused(arguments, message):
    with pytest.raises(bondcell.InputError, match=message):
        bondcell.reduce_series(series(), **arguments)


def test_what_is_no_file_or_no_series_is_refused(tmp_path):
    with pytest.raises(bondcell.InputError, match="file = None"):
        bondcell.read_prony(None)
    (tmp_path / "bare.csv").write_text("g,k,tau\n")
    with pytest.raises(bondcell.InputError, match="rows = 'none'"):
        bondcell.read_prony(tmp_path / "bare.csv")
    with pytest.raises(bondcell.InputError, match="series = 'NoneType'"):
        bondcell.reduce_series(None, 2, (1.0, 2.0))


def test_table_of_one_bond(tmp_path):
    one = bondcell.reduce_series(series(), 3, (1e-4, 1e4)).isel(gap=0)
    path = bondcell.write_bond_table(one, tmp_path / "bond.csv")
    lines = path.read_text().splitlines()
    remarks = [line for line in lines if line.startswith("#")]
    assert any("model: generatrix" in line for line in remarks)
    assert any(line.startswith("# reduction_error") for line in remarks)
    rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
    stiffness = [float(row["stiffness [N m-1]"]) for row in rows]
    times = [float(row["relaxation_time [s]"]) for row in rows]
    np.testing.assert_array_equal(stiffness, [one.K_inf.item(), *one.K_k.values])
    np.testing.assert_array_equal(times, [np.inf, *one.tau_k.values])
    with pytest.raises(bondcell.InputError, match="one point"):
        bondcell.write_bond_table(series(), tmp_path / "bonds.csv")
    with pytest.raises(bondcell.InputError, match="K_inf"):
        bondcell.write_bond_table(xr.Dataset(), tmp_path / "none.csv")
