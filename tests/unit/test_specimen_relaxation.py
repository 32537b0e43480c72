"""The specimen's lattices in a relaxing matrix."""

import numpy as np
import pytest

from bondcell.errors import InputError
from bondcell.prony.prony import Prony
from bondcell.specimen.bonds import Material
from bondcell.specimen.relaxation import specimen_relaxation
from bondcell.specimen.specimen import specimen

SERIES = Prony(weights=[0.5, 0.3], times=[1.0, 100.0], relative_to="instantaneous")
TIME = [0.0, 0.3, 30.0, 1e6]


def test_ends_are_the_elastic_specimens():
    data = specimen_relaxation(SERIES, TIME, ["lattice_fsi"], "constant_bulk")
    base = Material()
    shear, bulk = base.young_matrix / 2.92, base.young_matrix / (3 * 0.08)
    ratio = 0.2 * shear / bulk
    relaxed = Material(
        young_matrix=9 * 0.2 * shear / (3 + ratio), poisson_matrix=(3 - 2 * ratio) / (6 + 2 * ratio)
    )
    for material, at in ((base, 0), (relaxed, -1)):
        elastic = specimen(["lattice_fsi"], walls=["free"], material=material)
        expected = elastic.energy.squeeze().values
        np.testing.assert_allclose(data.energy[0, :, at], expected, rtol=1e-5)
    assert (data.reaction.diff("time") < 0).all()
    assert (data.fit_error < 1e-5).all()


def test_constant_poisson_is_the_modulus_itself():
    data = specimen_relaxation(SERIES, TIME, ["lattice_fsi"], "constant_poisson")
    share = SERIES.shear.relaxation(np.array(TIME))
    for loading in range(2):
        own = data.reaction[0, loading] / data.reaction[0, loading, 0]
        np.testing.assert_allclose(own, share, rtol=1e-12)


def test_bad_requests():
    with pytest.raises(InputError) as caught:
        specimen_relaxation(
            Prony(weights=[1.0], times=[1.0], relative_to="instantaneous"), TIME, ["glass"]
        )
    assert [violation.field for violation in caught.value.violations] == ["methods", "prony"]
