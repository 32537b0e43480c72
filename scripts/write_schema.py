"""Write params/scene.schema.json, which lets editors complete and check scene files."""

import json
from pathlib import Path

from bondcell.scene import scene_json_schema

TARGET = Path(__file__).parents[1] / "params" / "scene.schema.json"

if __name__ == "__main__":
    TARGET.write_text(json.dumps(scene_json_schema(), indent=2) + "\n", encoding="utf-8")
    print(f"wrote {TARGET}")
