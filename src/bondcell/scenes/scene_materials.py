"""What the named materials of a scene say, read from their files."""

from __future__ import annotations

from pathlib import Path

from bondcell.errors import Violation
from bondcell.scenes.materials import FOLDER, MaterialError, known_materials, load_material
from bondcell.scenes.prony_block import PronyBlock


def read_materials(block: PronyBlock | None, folder: Path | None) -> list[Violation]:
    """Give a block the materials that it names.

    Parameters
    ----------
    block
        The block of a scene, None for a scene without.
    folder
        Where the materials are, None for nowhere.

    Returns
    -------
    list of Violation
        Names without a file, and everything that is wrong with the files.
    """
    violations: list[Violation] = []
    for i, name in enumerate(block.materials if block else ()):
        known = known_materials(folder) if folder else ()
        if folder is None or name not in known:
            files = ", ".join(known) or "none"
            allowed = f"a file of the folder {FOLDER} beside the scene: {files}"
            violations.append(Violation(f"prony.materials.{i}", name, allowed))
            continue
        try:
            material = load_material(folder, name)
        except MaterialError as error:
            place = f"{FOLDER}/{name}"
            violations += [
                Violation(f"{place}.{v.field}", v.value, v.allowed) for v in error.violations
            ]
            continue
        assert block is not None
        block.add_material(name, material)
    return violations
