"""Figures: which are drawn of what, that they carry their words, that bytes repeat."""

from xml.etree import ElementTree

import numpy as np
import pytest
import xarray as xr
from matplotlib.colors import to_rgb

from bondcell.figures import draw_scene, sweep_drawings
from bondcell.figures.convergence import convergence_drawings
from bondcell.figures.curves import draw_curves
from bondcell.figures.error_maps import draw_error_maps
from bondcell.figures.layout import line_layout, map_layout
from bondcell.figures.style import LINES, drawing_style, save
from bondcell.scenes.parsing import parse_scene

SCENE = parse_scene(
    {
        "title": "A scene",
        "models": ["fsi"],
        "cell": {
            "radius_i": "7.5 mm",
            "gap": "0.5 mm",
            "young_i": "30 GPa",
            "poisson_i": 0.25,
            "young_m": "1.4 MPa",
            "poisson_m": 0.46,
        },
    }
)
DUBLIN_CORE = "{http://purl.org/dc/elements/1.1/}"


@pytest.fixture(scope="module")
def drawn(synthetic, tmp_path_factory):
    folder = tmp_path_factory.mktemp("figures")
    paths = draw_scene(SCENE, synthetic.maps, synthetic.convergence, folder)
    return {path.name: path for path in paths}


def test_every_figure_as_svg_and_png(drawn):
    names = {"stiffness", "error_maps", "convergence_dof", "convergence_time"}
    assert set(drawn) == {f"{name}.{suffix}" for name in names for suffix in ("svg", "png")}
    for name, path in drawn.items():
        start = path.read_bytes()[:8]
        assert start == b"\x89PNG\r\n\x1a\n" if name.endswith("png") else start.startswith(b"<?xml")
    assert all(path.stat().st_size < 700_000 for path in drawn.values())


def test_figures_carry_caption_and_description(drawn):
    for name, path in drawn.items():
        if name.endswith("svg"):
            root = ElementTree.parse(path).getroot()
            for field in ("title", "description"):
                assert len(root.findtext(f".//{DUBLIN_CORE}{field}")) > 40, (name, field)


def test_description_tells_the_errors(synthetic):
    words = draw_curves(synthetic.figure4).description
    assert "ν_m = 0.46: finite elements 587.9 MN/m to 3.495 kN/m" in words.replace("from ", "")
    assert "Error of FSI (paper) −48 % to −14 %" in words


def test_the_same_data_give_the_same_bytes(synthetic, tmp_path):
    for folder in ("one", "two"):
        with drawing_style():
            save(draw_curves(synthetic.point.expand_dims(gap=[1e-3, 2e-3])), tmp_path / folder)
    for name in ("stiffness.svg", "stiffness.png"):
        assert (tmp_path / "one" / name).read_bytes() == (tmp_path / "two" / name).read_bytes()


def test_panels_and_what_is_held_fixed(synthetic):
    layout = line_layout(synthetic.maps)
    assert (layout.x, layout.panel_axis, len(layout.panels)) == ("modulus_ratio", "poisson_m", 3)
    assert layout.fixed == "L_g/R_i = 0.03162"
    layout = line_layout(synthetic.figure4, x="poisson_m")
    assert layout.panels[0].title == "$E_i/E_m$ = 1"
    layout = map_layout(synthetic.maps)
    assert (layout.x, layout.y) == ("gap_ratio", "modulus_ratio")
    assert map_layout(synthetic.figure4) is None


def test_any_axes_can_be_drawn(synthetic):
    """Other names, more or fewer axes, no coordinate, no reference: something is drawn."""
    bare = synthetic.figure4.rename(modulus_ratio="radius_j", poisson_m="case").drop_vars("case")
    for study in (
        bare,
        bare.sel(model=["fsi"]),
        bare.isel(case=0),
        synthetic.figure4.sel(model=["fe"]),
        synthetic.maps.drop_vars("young_i").expand_dims(young_i=[1e9, 3e10, 1e11]),
        synthetic.maps.isel(poisson_m=0, drop=True),
    ):
        drawings = list(sweep_drawings(study))
        assert drawings
        assert all(drawing.caption and drawing.description for drawing in drawings)


def test_single_point_is_drawn_as_bars(synthetic):
    (drawing,) = sweep_drawings(synthetic.point)
    assert "FSI (paper): 84.06 kN/m (−48 %)" in drawing.description
    assert "cementation: no value" in drawing.description


def test_nothing_to_draw():
    assert not list(sweep_drawings(xr.Dataset()))


def test_failed_points_leave_gaps(synthetic):
    study = synthetic.maps.copy(deep=True)
    study["stiffness"].loc[{"model": ["fsi", "fe"]}] = np.nan
    assert "FSI (paper), ν_m = 0: no value" in draw_error_maps(study).description
    assert draw_curves(study).caption


def test_one_error_map_for_each_model_and_panel(synthetic):
    figure = draw_error_maps(synthetic.maps).figure
    assert len([axes for axes in figure.axes if axes.collections]) >= 6


def test_convergence_panels(synthetic):
    dof, seconds = convergence_drawings(synthetic.convergence)
    assert [axes.get_title() for axes in dof.figure.axes] == [
        "base (roller)",
        "narrow gap (roller)",
    ]
    assert len(dof.figure.axes[0].lines) == 2
    assert len(seconds.figure.axes[0].lines) == 4
    assert "FSI (paper): error 0.48 at 100 ns" in seconds.description


def luminance(colour):
    channels = np.array(to_rgb(colour))
    linear = np.where(channels <= 0.03928, channels / 12.92, ((channels + 0.055) / 1.055) ** 2.4)
    return linear @ [0.2126, 0.7152, 0.0722]


def test_lines_differ_in_more_than_colour_and_stand_out():
    dashes = [str(style["linestyle"]) for style in LINES.values()]
    assert len({*dashes}) >= len(dashes) - 1  # fsi and slices are solid, of other weight
    assert len({style["marker"] for style in LINES.values()}) == len(LINES)
    assert all(1.05 / (luminance(style["color"]) + 0.05) > 2 for style in LINES.values())
