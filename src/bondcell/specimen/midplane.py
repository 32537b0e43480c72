"""The solid's field in the specimen's mid-plane: displacements and principal stresses."""

from __future__ import annotations

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from bondcell.cell import FloatArray
from bondcell.solid.elements import physical_gradients, reference_nodes, shape_gradients
from bondcell.specimen.bonds import Material

# Corners of each side of a tetrahedron, then the middles of its edges.
_SIDES = np.array([[0, 1, 2, 4, 5, 6], [0, 1, 3, 4, 8, 7], [0, 2, 3, 6, 9, 7], [1, 2, 3, 5, 9, 8]])

# A second-order triangle as four first-order ones.
_QUARTERS = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]])

IN_PLANE = 1e-9
"""How near to the plane a node in it is [m]."""


def midplane(field: xr.Dataset, material: Material) -> xr.Dataset:
    """Cut a field at z = 0, where the specimen is symmetric.

    Parameters
    ----------
    field
        Of the half z >= 0, as `bondcell.specimen.run.run_part` gives it.
    material
        Elastic constants.

    Returns
    -------
    xarray.Dataset
        ``triangle`` (vertices of flat triangles), ``triangle_particle`` (0 in the matrix); on
        ``vertex``: ``place``, ``displacement`` (x, y) and ``principal_stress`` (largest and
        smallest) by loading. Vertices on an interface come twice, once for each material.

    Notes
    -----
    The stress at a node is the mean of what the elements of its material give there.
    """
    points, elements = field["point"].values, field["element"].values.astype(np.int64)
    own = field["particle"].values
    rows, sides = np.nonzero((np.abs(points[elements[:, _SIDES], 2]) < IN_PLANE).all(axis=2))
    faces = elements[rows[:, np.newaxis], _SIDES[sides]]
    key = faces * (own.max() + 2) + (own[rows] + 1)[:, np.newaxis]
    unique, first, number = np.unique(key, return_index=True, return_inverse=True)
    number = number.reshape(faces.shape)
    nodes = faces.ravel()[first]
    cut = elements[rows]
    stresses = []
    for loading in field["loading"].values:
        shift = field["displacement"].sel(loading=loading).values
        each = _stress(points[cut], shift[cut], own[rows], material)
        taken = each[np.arange(rows.size)[:, np.newaxis], _SIDES[sides]]
        total = np.zeros((unique.size, 3, 3))
        np.add.at(total, number, taken)
        mean = total / np.bincount(number.ravel())[:, np.newaxis, np.newaxis]
        stresses.append(np.linalg.eigvalsh(mean)[:, [2, 0]])
    triangles = number[:, _QUARTERS].reshape(-1, 3)
    shift = field["displacement"].values[nodes][:, :2]
    return xr.Dataset(
        {
            "place": (
                ("vertex", "component"),
                points[nodes, :2],
                {"units": "m", "long_name": "place"},
            ),
            "displacement": (
                ("vertex", "component", "loading"),
                shift,
                {"units": "m", "long_name": "displacement"},
            ),
            "principal_stress": (
                ("loading", "vertex", "end"),
                np.array(stresses),
                {"units": "Pa", "long_name": "largest and smallest principal stress"},
            ),
            "triangle": (
                ("triangle_number", "corner"),
                triangles.astype(np.int32),
                {"units": "1", "long_name": "vertices of the triangle"},
            ),
            "triangle_particle": (
                "triangle_number",
                np.repeat(own[rows] + 1, 4).astype(np.int32),
                {"units": "1", "long_name": "particle of the triangle, 0 in the matrix"},
            ),
        },
        {"component": ["x", "y"], "loading": field["loading"], "end": ["largest", "smallest"]},
        {"walls": field.attrs.get("walls", "")},
    )


def _stress(
    corners: FloatArray, shift: FloatArray, own: NDArray[np.int64], material: Material
) -> FloatArray:
    """Stresses at the nodes of elements [Pa], shape (elements, 10, 3, 3)."""
    slopes, _ = physical_gradients(corners, shape_gradients(reference_nodes(2)), np.ones(10))
    gradient = np.einsum("eqai,eaj->eqji", slopes, shift)
    strain = (gradient + gradient.transpose(0, 1, 3, 2)) / 2
    inside = own >= 0
    young = np.where(inside, material.young_particle, material.young_matrix)
    poisson = np.where(inside, material.poisson_particle, material.poisson_matrix)
    shear = (young / (2 * (1 + poisson)))[:, None, None, None]
    first = (young * poisson / ((1 + poisson) * (1 - 2 * poisson)))[:, None]
    trace = np.trace(strain, axis1=2, axis2=3)
    result: FloatArray = 2 * shear * strain
    result += (first * trace)[..., None, None] * np.eye(3)
    return result
