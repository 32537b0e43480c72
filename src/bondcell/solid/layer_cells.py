"""Triangular layers of rigid spheres in a plate: their energies, inside and at a border."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bondcell.cell import FloatArray
from bondcell.solid.mirror_cell import EVEN, FREE, ODD, mirror_cell
from bondcell.solid.stiffness import Elastic

PER_GAP = 1.0
"""Element size relative to the gap."""


@dataclass(frozen=True)
class Layer:
    """A triangular layer of equal spheres in the mid-plane of a plate with free faces.

    Parameters
    ----------
    radius, gap
        Of the spheres [m].
    depth
        Thickness of the plate [m].
    matrix
        The matrix material.
    """

    radius: float
    gap: float
    depth: float
    matrix: Elastic

    @property
    def length(self) -> float:
        """Distance of the centres [m]."""
        return 2 * self.radius + self.gap

    @property
    def height(self) -> float:
        """Distance of the rows [m]."""
        return float(np.sqrt(3) / 2 * self.length)


@dataclass(frozen=True)
class TriangleEnergies:
    """``2 U`` of one triangle of neighbours inside an endless layer [J].

    Parameters
    ----------
    dilation, deviator
        Under the strains (1, 1) and (1, -1).
    turn
        All spheres turn by one radian on their places.
    twist
        They turn by one radian, each row against the next ones.
    """

    dilation: float
    deviator: float
    turn: float
    twist: float


def triangle_energies(layer: Layer, per_gap: float = PER_GAP) -> TriangleEnergies:
    """Strain an endless layer, and turn its spheres.

    Notes
    -----
    The planes through rows of centres and across them are mirrors of the layer; strains along the
    axes are even, rotations odd there. The cell between such planes, ``L/2`` by ``sqrt(3) L/2``,
    holds two quarter spheres in opposite corners and is one triangle's share.
    """
    far = np.array([layer.length / 2, layer.height])
    box = np.array([[0, far[0]], [0, far[1]], [0, layer.depth / 2]])
    cell = mirror_cell(np.array([[0, 0], far]), layer.radius, box, layer.matrix, per_gap)
    strains = np.array([np.eye(2), np.diag([1.0, -1.0])])
    strained = cell.energies([EVEN] * 4, np.zeros((2, 2, 3)), strains)
    turns = np.zeros((2, 2, 3))
    turns[0, :, 2], turns[1, :, 2] = 1.0, [1.0, -1.0]
    turned = cell.energies([ODD] * 4, turns)
    return TriangleEnergies(*np.diag(strained).tolist(), *np.diag(turned).tolist())


@dataclass(frozen=True)
class BorderEnergies:
    """``2 U`` of the last row of a layer, by sphere; the row below it is at rest.

    Parameters
    ----------
    alternate
        Of displacements along the row [m] and rotations [rad] whose signs change from sphere to
        sphere, shape (2, 2).
    turn
        All spheres of the row turn by one radian [J].
    """

    alternate: FloatArray
    turn: float


def border_energies(layer: Layer, cover: float, per_gap: float = PER_GAP) -> BorderEnergies:
    """Move the last row of a layer that ends in a free surface beyond it.

    Parameters
    ----------
    layer
        The layer.
    cover
        From the centres of the row to the surface [m], more than the radius.
    per_gap
        Element size relative to the gap.

    Notes
    -----
    The cell is half a sphere of the row wide and goes down to the mirror through the next row.
    """
    half, height = layer.length / 2, layer.height
    box = np.array([[0, half], [-height, cover], [0, layer.depth / 2]])
    centres = np.array([[0, 0], [half, -height]])
    cell = mirror_cell(centres, layer.radius, box, layer.matrix, per_gap)
    motions = np.zeros((2, 2, 3))
    motions[0, 0, 0] = motions[1, 0, 2] = 1.0
    # The other half of each sphere of the row doubles all energies.
    alternate = 2 * cell.energies([ODD, EVEN, EVEN, FREE], motions)
    turn = 2 * cell.energies([ODD, ODD, EVEN, FREE], motions[1:])
    return BorderEnergies(alternate, float(turn[0, 0]))
