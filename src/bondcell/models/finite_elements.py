"""The entry of the finite element reference, whose numbers `bondcell.evaluate` takes from `fem`."""

from __future__ import annotations

from typing import Never

from bondcell.errors import BondcellError
from bondcell.models.model import Model


def _solved_by_geometry(*_args: object, **_options: object) -> Never:
    raise BondcellError("the reference is solved by geometry: call bondcell.evaluate")


FE = Model(
    name="fe",
    title="finite elements",
    summary="High-order finite elements of the cell itself (a Fourier mode a load), with an error "
    "estimate.",
    source="This project; an independent discretisation by triangles checks it.",
    valid_range="Every cell within the limits of the solver; points beyond them are flagged.",
    loads=dict.fromkeys(("normal", "shear", "torsion", "bending"), _solved_by_geometry),
    options={
        "bc": "End planes and sides of the normal load: 'roller' (frictionless plates, free "
        "sides; the default), 'clamped' (plates that hold the plane), 'confined' (frictionless "
        "plates and sides).",
        "tolerance": "Relative error of the stiffness asked for; default 1e-6.",
    },
    is_reference=True,
)
