"""The shipped scenes cut down: every kind of work that they ask for, as little of it as can be."""

import copy

from edited_scenes import SCENES


def _few(axis):
    if isinstance(axis, dict):
        return {**axis, "points": 2}
    return [axis[0], axis[-1]] if len(axis) > 1 else axis


def _small_prony(block):
    if "materials" in block:
        block["materials"] = block["materials"][:1]
    if "series" in block:
        block["series"] = dict([*block["series"].items()][-1:])
    if "spectrum" in block:
        block["spectrum"] = {"terms": [2], "decades": [2]}
    block["times"]["points"] = 4
    block["conventions"] = ["constant_bulk"]
    block["checks"] = min(block.get("checks", 0), 1)
    if "bond" in block:
        block["bond"].pop("error", None)
        block["bond"]["terms"] = 2
    if "methods" in block:
        block["methods"] |= {"order": 2, "steps": [1], "nodes": [4], "times": 2}


def _small_specimen(block):
    for name in ("elastic", "rigid"):
        if name in block:
            few = {"orders": block[name]["orders"][:1]} if "orders" in block[name] else {}
            block[name] = {walls: [2] for walls in block[name] if walls != "orders"} | few
    if "relaxation" in block:
        series = {"weights": [0.5], "times": ["1 s"]}
        times = {**block["relaxation"]["times"], "points": 3}
        block["relaxation"] |= {"series": series, "times": times, "per_gap": 2}
    if "finite_strain" in block:
        block["finite_strain"] |= {"steps": 1, "methods": ["lattice_fsi"]}


def _small(scene):
    scene = copy.deepcopy(scene)
    scene["sweep"] = {name: _few(axis) for name, axis in scene.get("sweep", {}).items()}
    if not scene["sweep"]:
        del scene["sweep"]
    if "reference" in scene:
        scene["reference"]["tolerance"] = 1e-2
    if "convergence" in scene:
        block = scene["convergence"]
        block["cases"] = {"base": {}}
        block["repeats"] = 1
        for name, most in (
            ("orders", [2, 3]),
            ("gradings", [3]),
            ("sizes", [2]),
            ("basis_order", 2),
        ):
            if name in block:
                block[name] = most
    if "prony" in scene:
        _small_prony(scene["prony"])
    if "specimen" in scene:
        _small_specimen(scene["specimen"])
    return scene


SMALL = {name: _small(scene) for name, scene in SCENES.items()}
