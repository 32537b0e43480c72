"""Compressible neo-Hookean elements: energy, nodal forces, tangent."""

from __future__ import annotations

import numpy as np

from bondcell.cell import FloatArray
from bondcell.fem.blocks import IndexArray
from bondcell.solid.elements import inverse
from bondcell.solid.stiffness import Stiffness, assemble_local, chunks
from bondcell.solid.tets import Tets


class NeoHookean:
    """Elements of a compressible neo-Hookean solid.

    Parameters
    ----------
    mesh
        The mesh in its natural state.
    lam, mu
        Lame's constants of the elements at small strain [Pa], shape (elements,).

    Notes
    -----
    ``W = mu/2 (tr F^T F - 3 - 2 ln J) + lambda/2 (ln J)^2``, F the deformation gradient, J its
    determinant; first Piola-Kirchhoff stress ``P = mu (F - F^-T) + lambda ln J F^-T``.
    """

    def __init__(self, mesh: Tets, lam: FloatArray, mu: FloatArray) -> None:
        self._mesh, self._lam, self._mu = mesh, lam, mu
        self._elements = np.arange(len(mesh.nodes))

    def _gradient(
        self, own: IndexArray, gradients: FloatArray, field: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """``F - 1``, its inverse ``F^-1`` and ``J``, shape (chunk, points, 3, 3) and without."""
        moved = field[self._mesh.nodes[own]]
        strain = moved.transpose(0, 2, 1)[:, np.newaxis] @ gradients
        back, volume = inverse(strain + np.eye(3))
        return strain, back, volume

    def energy_and_forces(self, field: FloatArray) -> tuple[float, FloatArray]:
        """Energy [J] and nodal forces [N] of displacements, shape (nodes, 3).

        An element turned inside out has infinite energy.
        """
        energy, forces = 0.0, np.zeros_like(field)
        for own, gradients, weights in chunks(self._mesh, self._elements):
            strain, back, volume = self._gradient(own, gradients, field)
            if (volume <= 0).any():
                return np.inf, forces
            lam, mu = self._lam[own, None], self._mu[own, None]
            # tr F^T F - 3 = 2 tr H + H : H, H = F - 1: nothing cancels at small strain.
            stretch = 2 * np.trace(strain, axis1=2, axis2=3) + (strain**2).sum(axis=(2, 3))
            log = np.log(volume)
            density = mu / 2 * (stretch - 2 * log) + lam / 2 * log**2
            energy += float((density * weights).sum())
            pressure = (lam * log - mu)[..., None, None] * back.swapaxes(2, 3)
            stress = mu[..., None, None] * (strain + np.eye(3)) + pressure
            stress *= weights[..., None, None]
            local = np.einsum("eqaj,eqij->eai", gradients, stress)
            np.add.at(forces, self._mesh.nodes[own], local)
        return energy, forces

    def tangent(self, field: FloatArray) -> Stiffness:
        """Tangent stiffness at displacements, shape (nodes, 3).

        Notes
        -----
        With G the gradients on the deformed and g on the natural body,
        ``K_(ai)(bk) = integral of lambda G_ai G_bk + (mu - lambda ln J) G_ak G_bi
        + mu delta_ik g_a.g_b``.
        """

        def local(own: IndexArray, gradients: FloatArray, weights: FloatArray) -> FloatArray:
            _, back, volume = self._gradient(own, gradients, field)
            lam, mu = self._lam[own, None], self._mu[own, None]
            count, points, nodes = gradients.shape[:3]
            now = (gradients @ back).reshape(count, points, 3 * nodes)
            turned = now.transpose(0, 2, 1)
            result = (turned * (lam * weights)[:, None]) @ now
            mixed = (turned * ((mu - lam * np.log(volume)) * weights)[:, None]) @ now
            shape = (count, nodes, 3, nodes, 3)
            result += mixed.reshape(shape).transpose(0, 1, 4, 3, 2).reshape(result.shape)
            natural = np.einsum("eqaj,eqbj,eq->eab", gradients, gradients, mu * weights)
            view = result.reshape(shape)
            for i in range(3):
                view[:, :, i, :, i] += natural
            return result

        return assemble_local(self._mesh, self._elements, local)
