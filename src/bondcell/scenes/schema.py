"""JSON schemas of the parameter files, for editors: ``python -m bondcell.scenes.schema``."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

from bondcell.scenes.fields import SceneSchema
from bondcell.scenes.materials import material_json_schema
from bondcell.scenes.scene import Scene
from bondcell.scenes.study_list import study_list_json_schema


def scene_json_schema() -> dict[str, Any]:
    """JSON schema of a scene file, for editors."""
    schema = Scene.model_json_schema(schema_generator=SceneSchema)
    about = {
        "title": "bondcell scene",
        "description": "What it names is computed; what it leaves out is not even imported.",
    }
    return {"$schema": SceneSchema.schema_dialect, **schema, **about}


def schema_texts() -> dict[str, str]:
    """File name -> content of every generated schema."""
    schemas = {
        "scene.schema.json": scene_json_schema(),
        "material.schema.json": material_json_schema(),
        "study.schema.json": study_list_json_schema(),
    }
    return {
        name: json.dumps(schema, indent=2, ensure_ascii=False) + "\n"
        for name, schema in schemas.items()
    }


def write_schemas(folder: str | Path = "params") -> list[Path]:
    """Write the schemas into the folder of the parameter files.

    Parameters
    ----------
    folder
        An existing folder.

    Returns
    -------
    list of Path
        The files whose content changed.
    """
    changed = []
    for name, text in schema_texts().items():
        path = Path(folder) / name
        if not path.is_file() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")
            changed.append(path)
    return changed


if __name__ == "__main__":
    for changed_file in write_schemas(*sys.argv[1:2]):
        print(changed_file)
