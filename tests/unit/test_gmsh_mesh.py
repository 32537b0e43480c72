"""Meshes of the section, and manners of the gmsh session."""

import builtins
import signal

import gmsh
import numpy as np
import pytest

from bondcell.errors import BondcellError, MissingLibrary
from bondcell.fem import gmsh_mesh
from bondcell.fem.gmsh_mesh import LARGEST_SIZE, Section, expected_triangles, triangle_mesh
from bondcell.fem.gmsh_session import gmsh_model
from bondcell.fem.section_mesh import (
    MATRIX,
    PARTICLE_I,
    PARTICLE_J,
    TriangleMesh,
    gradients_at_nodes,
)

SECTIONS = {
    "equal": Section(1.0, 1.0, 1 / 15),
    "half": Section(1.0, 1.0, 1 / 15, half=True),
    "unequal": Section(0.3, 1.0, 0.05),
    "wide": Section(0.8, 0.5, 0.1),
    "fine_corners": Section(0.8, 1.0, 0.1, fine_corners=True),
    "nearly_touching_the_side": Section(1 - 1e-7, 1.0, 0.2),
    "narrow": Section(1.0, 1.0, 1e-5, half=True),
}


@pytest.fixture(params=SECTIONS.values(), ids=SECTIONS)
def section(request):
    return request.param


def quadrature_areas(mesh):
    """Area of each material from the curved triangles; mid-side points are exact for the sum."""
    gradients = gradients_at_nodes()[3:]
    jacobian = np.einsum("cae,nap->encp", mesh.points[:, mesh.triangles], gradients)
    area = np.abs(np.linalg.det(jacobian)).sum(axis=1) / 6
    return {m: area[mesh.material == m].sum() for m in (PARTICLE_I, PARTICLE_J, MATRIX)}


def test_nodes_of_the_surfaces_lie_on_the_circles(section):
    mesh = triangle_mesh(section, 1.0)
    r, z = mesh.points[:, mesh.lines["arc_i"]]
    np.testing.assert_allclose(np.hypot(r, z), section.radius_i, rtol=1e-14)
    if not section.half:
        r, z = mesh.points[:, mesh.lines["arc_j"]]
        np.testing.assert_allclose(np.hypot(r, z - section.length), section.radius_j, rtol=1e-14)


def test_straight_lines_hold_the_nodes_of_the_outline(section):
    mesh = triangle_mesh(section, 1.0)
    r, z = mesh.points
    top = section.length / (2 if section.half else 1)
    for name, on_line in {
        "axis": r == 0,
        "bottom": z == 0,
        "top": np.isclose(z, top, rtol=1e-13),
        "lateral": np.isclose(r, 1, rtol=1e-9),
    }.items():
        np.testing.assert_array_equal(mesh.lines[name], np.flatnonzero(on_line), err_msg=name)


def test_areas(section):
    area = quadrature_areas(triangle_mesh(section, 0.5))
    discs = {PARTICLE_I: section.radius_i**2, PARTICLE_J: section.radius_j**2}
    if section.half:
        discs[PARTICLE_J] = 0.0
    for particle, square in discs.items():
        assert area[particle] == pytest.approx(np.pi / 4 * square, rel=1e-5)
    height = section.length / (2 if section.half else 1)
    assert sum(area.values()) == pytest.approx(height, rel=1e-12)


@pytest.mark.parametrize("size", [2.0, 1.4, 1.0, 0.6, 0.3])
@pytest.mark.parametrize("gap", [1e-4, 1e-2, 1.0])
def test_no_triangle_is_inverted_in_the_zero_angle_end(size, gap):
    mesh = triangle_mesh(Section(1.0, 1.0, gap, half=True), size)
    assert mesh.material.size == pytest.approx(
        expected_triangles(Section(1.0, 1.0, gap), size) / 2, rel=1.0, abs=400
    )


def test_sizes_follow_the_gap_and_are_limited():
    size, gap = 0.5, 1 / 15
    mesh = triangle_mesh(Section(1.0, 1.0, gap), size)
    corners = mesh.points[:, mesh.triangles[:3]]
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=0).max(axis=0)
    assert longest.max() < 2 * size * LARGEST_SIZE
    in_film = (mesh.material == MATRIX) & (corners[0].max(axis=0) < gap)
    assert in_film.any()
    assert longest[in_film].max() < 2 * size * gap


def test_same_input_same_mesh():
    first, second = (triangle_mesh(SECTIONS["unequal"], 0.7) for _ in range(2))
    np.testing.assert_array_equal(first.points, second.points)
    np.testing.assert_array_equal(first.triangles, second.triangles)


def test_inverted_triangle_is_reported(monkeypatch):
    monkeypatch.setattr(TriangleMesh, "is_inverted", lambda mesh: True)
    with pytest.raises(BondcellError, match=r"size 1\.0 is inverted"):
        triangle_mesh(SECTIONS["half"], 1.0)


def test_inversion_is_seen():
    points = np.array([[0, 1, 0, 0.5, 0.5, 0], [0, 0, 1, 0, 0.5, 0.5]])
    triangles = np.arange(6)[:, np.newaxis]
    straight = TriangleMesh(points, triangles, np.array([MATRIX]), {})
    assert not straight.is_inverted()
    points[:, 4] = 0.2
    assert straight.is_inverted()


def test_failure_in_gmsh_is_named_and_ends_the_session(monkeypatch):
    def fail(*_):
        raise Exception("no such curve")

    monkeypatch.setattr(gmsh_mesh, "_set_size", fail)
    with pytest.raises(BondcellError, match="no such curve"):
        triangle_mesh(SECTIONS["half"], 1.0)
    assert not gmsh.isInitialized()


def test_session_leaves_signals_alone():
    before = signal.getsignal(signal.SIGINT)
    triangle_mesh(SECTIONS["half"], 2.0)
    assert signal.getsignal(signal.SIGINT) is before
    assert not gmsh.isInitialized()


@pytest.fixture
def host():
    """Somebody else's gmsh session with a model and an option of its own."""
    gmsh.initialize(interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("Mesh.MeshSizeFactor", 0.25)
    gmsh.model.add("host")
    gmsh.model.occ.addRectangle(0, 0, 0, 1, 1)
    gmsh.model.occ.synchronize()
    yield
    gmsh.finalize()


@pytest.mark.usefixtures("host")
@pytest.mark.parametrize("fails", [False, True])
def test_session_inside_another_one(fails, monkeypatch):
    alone = triangle_mesh(SECTIONS["half"], 1.0)
    if fails:
        monkeypatch.setattr(gmsh_mesh, "_read", lambda _: 1 / 0)
        with pytest.raises(BondcellError):
            triangle_mesh(SECTIONS["half"], 1.0)
    assert alone.material.size == pytest.approx(359, rel=0.2)
    assert gmsh.isInitialized()
    assert gmsh.model.getCurrent() == "host"
    assert gmsh.model.list()[-1] == "host"
    assert gmsh.option.getNumber("Mesh.MeshSizeFactor") == 0.25
    assert gmsh.model.getEntities(2) == [(2, 1)]


@pytest.mark.parametrize(
    ("error", "expected"),
    [
        (OSError("libGLU.so.1: cannot open shared object file"), "apt-get install .*libglu1-mesa"),
        (ModuleNotFoundError("No module named 'gmsh'"), "pip install gmsh"),
    ],
)
def test_missing_library_says_what_to_install_in_one_line(error, expected, monkeypatch):
    real_import = builtins.__import__

    def without_gmsh(name, *arguments):
        if name == "gmsh":
            raise error
        return real_import(name, *arguments)

    monkeypatch.setattr(builtins, "__import__", without_gmsh)
    with pytest.raises(MissingLibrary, match=expected) as caught, gmsh_model("any", {}):
        pass
    assert "\n" not in str(caught.value)
