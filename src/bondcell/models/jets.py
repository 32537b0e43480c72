"""Fields with their first and second derivatives, so that strains of products need no algebra."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bondcell.cell import FloatArray


@dataclass(frozen=True)
class Curve:
    """A function of one variable: value, first and second derivative, arrays of one shape.

    Examples
    --------
    >>> x = Curve.variable(np.array([2.0]))
    >>> (1.0 / (x * x)).second  # 6 x^-4
    array([0.375])
    """

    value: FloatArray
    first: FloatArray
    second: FloatArray

    __array_ufunc__ = None  # an array on the left leaves the product to this class

    @classmethod
    def variable(cls, value: FloatArray) -> Curve:
        """The variable itself."""
        return cls(value, np.ones_like(value), np.zeros_like(value))

    def __mul__(self, other: Curve | FloatArray | float) -> Curve:
        if not isinstance(other, Curve):
            return Curve(self.value * other, self.first * other, self.second * other)
        return Curve(
            self.value * other.value,
            self.first * other.value + self.value * other.first,
            self.second * other.value + 2 * self.first * other.first + self.value * other.second,
        )

    __rmul__ = __mul__

    def __add__(self, other: Curve | FloatArray | float) -> Curve:
        if not isinstance(other, Curve):
            return Curve(self.value + other, self.first, self.second)
        return Curve(self.value + other.value, self.first + other.first, self.second + other.second)

    __radd__ = __add__

    def __neg__(self) -> Curve:
        return Curve(-self.value, -self.first, -self.second)

    def __sub__(self, other: Curve | FloatArray | float) -> Curve:
        return self + (-other)

    def __rsub__(self, other: FloatArray | float) -> Curve:
        return (-self) + other

    def __truediv__(self, other: Curve) -> Curve:
        return self * (1.0 / other)

    def __rtruediv__(self, other: FloatArray | float) -> Curve:
        inverse = 1.0 / self.value
        return self.compose(other * inverse, -other * inverse**2, 2 * other * inverse**3)

    def sqrt(self) -> Curve:
        """Square root of a positive function."""
        root = np.sqrt(self.value)
        return self.compose(root, 0.5 / root, -0.25 / root**3)

    def compose(self, value: FloatArray, first: FloatArray, second: FloatArray) -> Curve:
        """``f(self)`` from f and its derivatives there."""
        return Curve(value, first * self.first, second * self.first**2 + first * self.second)


class Jet:
    """A function of (r, z): value, d/dr, d/dz, d2/dr2, d2/drdz, d2/dz2 on a leading axis of 6.

    Without second derivatives the axis has 3 entries, as has the result of what it is joined with.

    Examples
    --------
    >>> r, z = Jet.variables(np.array([2.0]), np.array([3.0]))
    >>> (r * r * z).parts[:, 0]
    array([12., 12.,  4.,  6.,  4.,  0.])
    """

    __array_ufunc__ = None

    def __init__(self, parts: FloatArray) -> None:
        self.parts = parts

    @classmethod
    def variables(cls, r: FloatArray, z: FloatArray) -> tuple[Jet, Jet]:
        """The coordinates themselves."""
        one, none = np.ones_like(r), np.zeros_like(r)
        return (
            cls(np.stack([r, one, none, none, none, none])),
            cls(np.stack([z, none, one, none, none, none])),
        )

    @property
    def value(self) -> FloatArray:
        """The function itself."""
        return self.parts[0]

    def first_order(self) -> Jet:
        """The same without second derivatives, for what needs none."""
        return Jet(self.parts[:3])

    def with_value(self, value: FloatArray) -> Jet:
        """The same derivatives; a value that the caller knows to more digits."""
        return Jet(np.concatenate((value[None], self.parts[1:])))

    def __mul__(self, other: Jet | FloatArray | float) -> Jet:
        if not isinstance(other, Jet):
            return Jet(self.parts * other)
        (a, a_r, a_z), (b, b_r, b_z) = self.parts[:3], other.parts[:3]
        order = min(len(self.parts), len(other.parts))
        out = np.empty((order, *np.broadcast_shapes(a.shape, b.shape)))
        out[0] = a * b
        out[1] = a_r * b + a * b_r
        out[2] = a_z * b + a * b_z
        if order > 3:
            (a_rr, a_rz, a_zz), (b_rr, b_rz, b_zz) = self.parts[3:], other.parts[3:]
            out[3] = a_rr * b + 2 * a_r * b_r + a * b_rr
            out[4] = a_rz * b + a_r * b_z + a_z * b_r + a * b_rz
            out[5] = a_zz * b + 2 * a_z * b_z + a * b_zz
        return Jet(out)

    __rmul__ = __mul__

    def __add__(self, other: Jet | FloatArray | float) -> Jet:
        if isinstance(other, Jet):
            order = min(len(self.parts), len(other.parts))
            return Jet(self.parts[:order] + other.parts[:order])
        out = self.parts.copy()
        out[0] += other
        return Jet(out)

    __radd__ = __add__

    def __neg__(self) -> Jet:
        return Jet(-self.parts)

    def __sub__(self, other: Jet | FloatArray | float) -> Jet:
        return self + (-other)

    def __rsub__(self, other: FloatArray | float) -> Jet:
        return (-self) + other

    def __truediv__(self, other: Jet) -> Jet:
        return self * (1.0 / other)

    def __rtruediv__(self, other: FloatArray | float) -> Jet:
        inverse = 1.0 / self.value
        return self.compose(other * inverse, -other * inverse**2, 2 * other * inverse**3)

    def sqrt(self) -> Jet:
        """Square root of a positive function."""
        root = np.sqrt(self.value)
        return self.compose(root, 0.5 / root, -0.25 / root**3)

    def log(self) -> Jet:
        """Logarithm of a positive function."""
        inverse = 1.0 / self.value
        return self.compose(np.log(self.value), inverse, -(inverse**2))

    def compose(self, value: FloatArray, first: FloatArray, second: FloatArray) -> Jet:
        """``f(self)`` from f and its derivatives there."""
        _, d_r, d_z, *curved = self.parts
        rows = [value, first * d_r, first * d_z]
        if curved:
            d_rr, d_rz, d_zz = curved
            rows.append(second * d_r**2 + first * d_rr)
            rows.append(second * d_r * d_z + first * d_rz)
            rows.append(second * d_z**2 + first * d_zz)
        return Jet(np.stack(rows))

    def times_function_of(self, inner: Jet) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Parts of ``self * f(inner)`` for any f: factors of f, f' and f''."""
        a, a_r, a_z = self.parts[:3]
        _, d_r, d_z, d_rr, d_rz, d_zz = inner.parts
        none = np.zeros_like(a)
        first = [
            none,
            a * d_r,
            a * d_z,
            2 * a_r * d_r + a * d_rr,
            a_r * d_z + a_z * d_r + a * d_rz,
            2 * a_z * d_z + a * d_zz,
        ]
        second = [none, none, none, a * d_r**2, a * d_r * d_z, a * d_z**2]
        return self.parts, np.stack(first), np.stack(second)
