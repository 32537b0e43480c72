"""The shipped scenes, edited at random: values, keys and types, or bytes of the file."""

import copy
from pathlib import Path

import yaml
from hypothesis import strategies as st

PARAMS = Path(__file__).parents[2] / "params"
FILES = {path.stem: path.read_bytes() for path in PARAMS.glob("*.yaml") if path.stem != "study"}
SCENES = {name: yaml.safe_load(content) for name, content in FILES.items()}


def places(block):
    """Every (container, key or position) inside nested mappings and lists."""
    items = block.items() if isinstance(block, dict) else enumerate(block)
    for key, value in items:
        yield block, key
        if isinstance(value, (dict, list)):
            yield from places(value)


KEYS = sorted(
    {key for scene in SCENES.values() for _, key in places(scene) if isinstance(key, str)}
    | {
        "gap_ratio",
        "temperatures",
        "frequencies",
        "checks",
        "own_modulus",
        "load",
        "name",
        "a.b",
        "",
    }
)

NUMBERS = st.one_of(
    st.integers(-3, 30),
    st.floats(),
    st.sampled_from([0, 5e-324, 1e-300, 1e-9, 0.5, 0.46, 1e7, 1e18, 10**30, 1e308]),
)
WORDS = st.sampled_from(
    [
        *(
            "",
            " ",
            "x",
            "é",
            "\x1b[31m",
            "a" * 5000,
            "yes",
            "010",
            "0x10",
            "1_000",
            "1,5",
            "\u0661",
        ),
        *("rigid", "inf", "nan", "1e500", "1e-400 mm", "7.5 mm", "1 um", "1 m", "1 MPa", "30 GPa"),
        *("1 s", "1 us", "20 degC", "-5 K", "46 %", "1 m**m", "1 m^2", "1/0", "__import__('os')"),
        *("${HOME}", "{{ 7*7 }}", "../x", "base", "sbs_ac13", "fe", "fsi", "film", "bounds"),
        *("normal", "torsion", "shear", "bending", "roller", "confined", "lin", "log"),
    ]
)
LEAVES = st.one_of(st.none(), st.booleans(), NUMBERS, WORDS)
RANGES = st.fixed_dictionaries(
    {"start": LEAVES, "stop": LEAVES, "points": st.sampled_from([2, 5, 10_000, 10**7, 1e12])},
    optional={"spacing": st.sampled_from(["lin", "log"])},
)
VALUES = st.recursive(
    LEAVES | RANGES,
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.dictionaries(st.sampled_from(KEYS), inner, max_size=4)
        | LEAVES.map(lambda leaf: [leaf, leaf])
    ),
    max_leaves=8,
)


def _replace(draw, scene, block, key):
    block[key] = draw(VALUES)


def _remove(draw, scene, block, key):
    del block[key]


def _rename(draw, scene, block, key):
    value = block.pop(key)
    name = draw(st.sampled_from(KEYS))
    if isinstance(block, dict):
        block[name] = value
    else:
        block.insert(0, {name: value})


def _wrap(draw, scene, block, key):
    value = block[key]
    block[key] = draw(st.sampled_from([[value], [value, value], {"start": value}, {"base": value}]))


def _move(draw, scene, block, key):
    """What stands at one place stands at another as well, under its own or the other's key."""
    other, name = draw(st.sampled_from(list(places(scene))))
    here = name if isinstance(block, dict) and draw(st.booleans()) else key
    block[here] = copy.deepcopy(other[name])


def _scale(draw, scene, block, key):
    if isinstance(block[key], (int, float)):
        block[key] *= draw(st.sampled_from([-1, 0, 1e3, 1e-3, 1e9, 1e-9, 1e300, 1 + 1e-15]))
    elif isinstance(block[key], str):
        block[key] = block[key].replace("m", draw(st.sampled_from(["", "M", "mm", "u"])))
    else:
        _replace(draw, scene, block, key)


EDITS = (_replace, _replace, _remove, _rename, _wrap, _move, _scale)


@st.composite
def edited_scenes(draw):
    """Bytes of a shipped scene with one to four edits of its content."""
    scene = copy.deepcopy(SCENES[draw(st.sampled_from(sorted(SCENES)))])
    for _ in range(draw(st.integers(1, 4))):
        found = list(places(scene))
        if found:
            draw(st.sampled_from(EDITS))(draw, scene, *draw(st.sampled_from(found)))
    text = yaml.safe_dump(scene, allow_unicode=True, sort_keys=False)
    return text.encode("utf-8", "surrogatepass")


INSERTED = st.sampled_from(
    [
        *(b"\t", b"\0", b"\xff", b"\xef\xbb\xbf", b"\r", b"\xc2\x85", b"\xe2\x80\xa8", b"1" * 500),
        *(b"&a ", b"*a", b"!!python/name:os.system ", b"!!int ", b"<<: ", b"? ", b": ", b"- "),
        *(b"---\n", b"...\n", b"%YAML 1.1\n", b"{", b"}", b"[", b"]", b"|", b">", b"#", b"'", b'"'),
        *(b"@", b"`", b"e999", b"\n", b" " * 30),
    ]
)


@st.composite
def damaged_files(draw):
    """Bytes of a shipped scene's file with one to six cuts, insertions, copies or end."""
    content = FILES[draw(st.sampled_from(sorted(FILES)))]
    for _ in range(draw(st.integers(1, 6))):
        at = draw(st.integers(0, len(content)))
        kind = draw(st.sampled_from(["insert", "insert", "cut", "copy", "byte", "end"]))
        head, tail = content[:at], content[at:]
        if kind == "insert":
            content = head + draw(INSERTED) + tail
        elif kind == "cut":
            content = head + tail[draw(st.integers(1, 12)) :]
        elif kind == "copy":
            start = draw(st.integers(0, len(content)))
            content = head + content[start : start + draw(st.integers(1, 40))] + tail
        elif kind == "byte":
            content = head + bytes([draw(st.integers(0, 255))]) + tail[1:]
        elif draw(st.booleans()):
            content = head
    return content
