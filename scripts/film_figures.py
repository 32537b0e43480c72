"""Draw the figures of docs/film.md; run by hand, the results are tracked."""

from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure

from bondcell.cell import Cell, FloatArray
from bondcell.models import MODELS

FOLDER = Path(__file__).parents[1] / "docs" / "figures"
GAP = np.geomspace(1e-4, 1.0, 33)
LOADS = {"normal": "#0072b2", "shear": "#d55e00", "torsion": "#009e73", "bending": "#882255"}


def stiffness(model: str, load: str, poisson: float, ratio: float) -> FloatArray:
    """Over E_m and R, equal spheres."""
    cell = Cell.from_values(
        radius_i=1.0, gap=GAP, young_i=ratio, young_m=1.0, poisson_i=0.25, poisson_m=poisson
    )
    return MODELS[model].loads[load](cell).stiffness


def interval(axes: Axes) -> None:
    """Bounds and FSI around the finite elements at two Poisson's ratios, E_i/E_m = 1000."""
    for poisson, colour in ((0.0, "#0072b2"), (0.46, "#d55e00")):
        lower, upper = (stiffness(m, "normal", poisson, 1e3) for m in ("generatrix", "film"))
        axes.fill_between(GAP, lower, upper, color=colour, alpha=0.2, linewidth=0)
        axes.plot(GAP, upper, color=colour, label=f"film, nu_m = {poisson}")
        exact = stiffness("surrogate", "normal", poisson, 1e3)
        axes.plot(GAP[::4], exact[::4], "o", color=colour, markersize=3.5)
    axes.plot(GAP, stiffness("fsi", "normal", 0.0, 1e3), "k--", label="FSI")
    axes.set(xscale="log", yscale="log", xlabel="gap / R", ylabel="K_n / (E_m R)")
    axes.set_title("film above, generatrix below, dots: finite elements")
    axes.legend(frameon=False, fontsize=8)


def errors(axes: Axes) -> None:
    """Error of the film model over the gap for the four loads, soft and stiff particles."""
    for load, colour in LOADS.items():
        for ratio, style in ((1.0, ":"), (1e2, "--"), (1e5, "-")):
            exact = stiffness("surrogate", load, 0.46, ratio)
            error = 100 * (stiffness("film", load, 0.46, ratio) / exact - 1)
            label = load if style == "-" else None
            axes.plot(GAP, error, style, color=colour, label=label)
    axes.set(xscale="log", yscale="log", xlabel="gap / R", ylabel="film above finite elements, %")
    axes.set(ylim=(1e-2, 10))
    axes.set_title("nu_m = 0.46; E_i/E_m = 1 dotted, 100 dashed, 1e5 full")
    axes.legend(frameon=False, fontsize=8)


def main() -> None:
    """Write one SVG a figure."""
    mpl.rcParams["svg.hashsalt"] = "bondcell"
    for name, draw in (("film_interval", interval), ("film_errors", errors)):
        figure = Figure(figsize=(5.2, 3.6), layout="constrained")
        FigureCanvasSVG(figure)
        draw(figure.add_subplot())
        figure.savefig(FOLDER / f"{name}.svg", metadata={"Date": None})


if __name__ == "__main__":
    main()
