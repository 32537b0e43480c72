"""Reference pages made from the code: API, command line, scene keys, variables, models."""

import argparse
import inspect
import json
from pathlib import Path

import bondcell
from bondcell.cli import parser
from bondcell.models import MODELS
from bondcell.results.variables import BY_LOAD, SWEPT, groups
from bondcell.scenes.materials import material_json_schema
from bondcell.scenes.schema import scene_json_schema

NOTE = "% Made by docs/reference_pages.py from the code: edit that.\n\n"


def write_pages(folder: Path) -> list[Path]:
    """Write every page whose text changed.

    Parameters
    ----------
    folder
        Where; made if need be.
    """
    folder.mkdir(exist_ok=True)
    pages = {
        "api": api_page,
        "cli": cli_page,
        "scene_keys": scene_page,
        "variables": variables_page,
        "models": models_page,
    }
    paths = []
    for name, make in pages.items():
        path, text = folder / f"{name}.md", NOTE + make()
        if not path.is_file() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")
        paths.append(path)
    return paths


def cell(text) -> str:
    """Text that does not break a table."""
    return " ".join(str(text).split()).replace("|", "\\|")


def code(text) -> str:
    """Text set as code in a table."""
    return f"`{cell(text)}`" if str(text) else ""


def table(head, rows) -> str:
    """A Markdown table."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines) + "\n"


# ---- API


def api_page() -> str:
    """Every public name with its docstring."""
    kinds = {"Functions": [], "Classes": [], "Exceptions": []}
    for name in bondcell.__all__:
        thing = getattr(bondcell, name)
        if inspect.isfunction(thing):
            kinds["Functions"].append(("autofunction", name, ""))
        elif inspect.isclass(thing) and issubclass(thing, Exception):
            kinds["Exceptions"].append(("autoexception", name, ""))
        elif inspect.isclass(thing):
            kinds["Classes"].append(("autoclass", name, "   :members:\n"))
    text = (
        "# Python\n\nAll of this is reached as `bondcell.<name>`; besides there are "
        "`bondcell.MODELS`, see [](models.md), and `bondcell.__version__`.\n"
    )
    for title, entries in kinds.items():
        text += f"\n## {title}\n"
        for directive, name, options in entries:
            text += f"\n```{{eval-rst}}\n.. {directive}:: bondcell.{name}\n{options}```\n"
    return text


# ---- command line


def cli_page() -> str:
    """Help of the command and of each subcommand."""
    whole = parser()
    text = "# Command line\n\n" + _help(whole)
    (commands,) = (a for a in whole._actions if isinstance(a, argparse._SubParsersAction))
    for name, command in commands.choices.items():
        text += f"\n## bondcell {name}\n\n" + _help(command)
    return text


def _help(command: argparse.ArgumentParser) -> str:
    command.formatter_class = _formatter(command.formatter_class)
    return f"```text\n{command.format_help().rstrip()}\n```\n"


def _formatter(base):
    return lambda prog: base(prog, width=92)


# ---- scenes


def scene_page() -> str:
    """Keys of a scene file and of a material file, from their JSON schemas."""
    text = (
        "# Scene keys\n\nEvery key of a scene file, block by block. The same as JSON schemas for "
        "editors: `params/scene.schema.json` and `params/material.schema.json`. How to write one: "
        "[](../scenes.md).\n"
    )
    text += _blocks(scene_json_schema(), "A scene")
    return text + _blocks(material_json_schema(), "A material")


def _blocks(schema: dict, title: str) -> str:
    text = f"\n## {title}\n\n" + _keys(schema)
    for name, block in schema.get("$defs", {}).items():
        if block.get("properties"):
            words = block.get("description", "").strip()
            text += f"\n### {name}\n\n{words}\n\n" + _keys(block)
    return text


def _keys(block: dict) -> str:
    required = block.get("required", [])
    rows = []
    for name, about in block["properties"].items():
        default = "required" if name in required else _default(about)
        rows.append([code(name), _type(about), default, cell(about.get("description", ""))])
    return table(["key", "value", "default", "meaning"], rows)


def _default(about: dict) -> str:
    default = about.get("default")
    return "" if default in (None, []) else code(json.dumps(default))


def _type(about: dict) -> str:
    """What a value may be, in a few words."""
    if "$ref" in about:
        return about["$ref"].rpartition("/")[2]
    for key in ("anyOf", "oneOf", "allOf"):
        if key in about:
            kinds = [_type(one) for one in about[key] if one.get("type") != "null"]
            return " or ".join(dict.fromkeys(kind for kind in kinds if kind))
    if "enum" in about:
        return ", ".join(code(one) for one in about["enum"])
    if about.get("type") == "array":
        inner = _type(about["items"]) if isinstance(about.get("items"), dict) else ""
        return f"list of {inner}" if inner else "list"
    if about.get("type") == "object":
        inner = about.get("additionalProperties")
        return f"names -> {_type(inner)}" if isinstance(inner, dict) else "block"
    kinds = about.get("type", "")
    return " or ".join(kinds) if isinstance(kinds, list) else kinds


# ---- variables


def variables_page() -> str:
    """What a study.nc may hold."""
    text = (
        "# Variables of study.nc\n\nTests compare this list with files as they are written. "
        f"`{SWEPT}` stands for the scene's swept axes; unit `{BY_LOAD}`: N m-1 under normal load "
        "and shear, N m rad-1 under torsion and bending. A file has those variables that its "
        "scene asks for. Missing values are NaN, and a flag of `status` says why; the flags and "
        "their meanings are attributes (`flag_values`, `flag_meanings`).\n"
    )
    for group in groups():
        text += f"\n## Group `{group.name}`: {group.where}\n\n"
        rows = [
            [code(one.name), cell(", ".join(one.dims)), cell(one.units), cell(one.meaning)]
            for one in group.variables
        ]
        text += table(["variable", "dimensions", "units", "meaning"], rows)
    flags = [[code(flag.value), code(flag.name), str(flag.has_value)] for flag in bondcell.Status]
    text += "\n## Flags of status\n\n" + table(["value", "meaning", "carries a number"], flags)
    return text


# ---- models


def models_page() -> str:
    """Every model's own description of itself."""
    text = "# Models\n\nWhat `bondcell.MODELS` says; which one to take: [](../choosing.md).\n"
    for name, model in MODELS.items():
        text += f"\n## {name}\n\n**{model.title}.** {model.summary}\n\n"
        rows = [
            ["loads", ", ".join(code(load) for load in model.loads)],
            ["valid range", cell(model.valid_range)],
            ["source", cell(model.source)],
        ]
        rows += [[f"option {code(key)}", cell(words)] for key, words in model.options.items()]
        text += table(["", ""], rows)
    return text
