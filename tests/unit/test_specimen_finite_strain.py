"""Lattices of the specimen with large rotations."""

import numpy as np
import pytest

from bondcell.errors import InputError
from bondcell.specimen.finite_strain import specimen_finite_strain


def test_opposite_directions_bracket_the_linear_energy():
    data = specimen_finite_strain(["lattice_fsi", "lattice_fe_beam"])
    linear = data.linear_energy
    np.testing.assert_allclose(
        linear.sel(direction=["+x", "+y"]), linear.sel(direction=["-x", "-y"]), rtol=1e-9
    )
    assert (abs(data.ratio - 1) < 0.1).all()
    assert (abs(data.ratio - 1) > 1e-5).any()


def test_unknown_names():
    with pytest.raises(InputError) as caught:
        specimen_finite_strain(["glass"], ["up"])
    assert [violation.field for violation in caught.value.violations] == ["methods", "directions"]
