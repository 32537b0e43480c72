"""Malformed scene files: name -> (bytes of the file, fields that the one error must name).

Most are `GOOD` with one line replaced; the rest are whole files.
"""

GOOD = """\
title: A scene
cell:
  radius_i: 7.5 mm
  gap: 0.5 mm
  young_i: 30 GPa
  poisson_i: 0.25
  young_m: 1.4 MPa
  poisson_m: 0.46
sweep:
  gap_ratio: [1e-2, 1e-1]
  poisson_m: {start: 0, stop: 0.4, points: 3}
models: [fsi, generatrix]
reference: {bc: [roller], tolerance: 1e-4}
contributions: true
convergence:
  cases: {base: {}}
  orders: [2, 4]
  repeats: 1
prony:
  series: {two: {weights: [0.6, 0.3], times: [1 ms, 10 s]}}
  times: {start: 1 us, stop: 1e3 s, points: 5}
"""

EDITS = {
    # types
    "cell_is_text": ("cell:\n  radius_i: 7.5 mm\n", "cell: 7.5 mm\nx:\n", {"cell", "x"}),
    "cell_is_list": ("cell:\n", "cell: [1]\nx:\n", {"cell", "x"}),
    "title_is_number": ("A scene", "5", {"title"}),
    "title_is_yes_of_yaml_1_1": ("contributions: true", "contributions: yes", {"contributions"}),
    "flag_is_on": ("contributions: true", "contributions: on", {"contributions"}),
    "flag_is_one": ("contributions: true", "contributions: 1", {"contributions"}),
    "flag_is_quoted": ("contributions: true", "contributions: 'true'", {"contributions"}),
    "length_is_flag": ("0.5 mm", "true", {"cell.gap"}),
    "length_is_list": ("0.5 mm", "[0.5 mm]", {"cell.gap"}),
    "length_is_mapping": ("0.5 mm", "{value: 0.5, unit: mm}", {"cell.gap"}),
    "length_is_missing": ("gap: 0.5 mm", "gap:", {"cell.gap"}),
    "models_is_text": ("[fsi, generatrix]", "fsi", {"models"}),
    "models_is_mapping": ("[fsi, generatrix]", "{fsi: true}", {"models"}),
    "axis_is_number": ("[1e-2, 1e-1]", "0.1", {"sweep.gap_ratio"}),
    "axis_holds_null": ("[1e-2, 1e-1]", "[1e-2, ~]", {"sweep.gap_ratio.1"}),
    "points_is_fraction": ("points: 3", "points: 2.5", {"sweep.poisson_m.points"}),
    "points_is_date": ("points: 3", "points: 2024-01-01", {"sweep.poisson_m.points"}),
    "orders_is_number": ("[2, 4]", "4", {"convergence.orders"}),
    "cases_is_list": ("{base: {}}", "[base]", {"convergence.cases"}),
    # numbers as YAML and people write them
    "exponent_without_number": ("tolerance: 1e-4", "tolerance: e-4", {"reference.tolerance"}),
    "decimal_comma": ("7.5 mm", "'7,5 mm'", {"cell.radius_i"}),
    "digit_groups": ("30 GPa", "30_000_000_000", {"cell.young_i"}),
    "hexadecimal": ("30 GPa", "0x1F", {"cell.young_i"}),
    "octal": ("points: 3", "points: 0o17", {"sweep.poisson_m.points"}),
    "sexagesimal": ("0.5 mm", "1:30", {"cell.gap"}),
    "expression": ("0.5 mm", "1/2", {"cell.gap"}),
    "code": ("0.5 mm", "__import__('os').getpid()", {"cell.gap"}),
    "template": ("0.5 mm", "'{{ gap }}'", {"cell.gap"}),
    "digits_of_another_script": ("7.5 mm", "\u0667 mm", {"cell.radius_i"}),
    "wide_digits": ("0.25", "\uff10.25", {"cell.poisson_i"}),
    "minus_sign_of_typography": ("0.46", "\u22120.46", {"cell.poisson_m"}),
    "number_beyond_double": ("30 GPa", "1e500", {"cell.young_i"}),
    "number_of_many_digits": ("30 GPa", "9" * 400, {"cell.young_i"}),
    "number_below_double": ("1.4 MPa", "1e-500", {"cell.young_m"}),
    "text_beyond_double": ("30 GPa", "1e308 GPa", {"cell.young_i"}),
    "nan": ("0.25", ".nan", {"cell.poisson_i"}),
    "infinite_length": ("0.5 mm", ".inf", {"cell.gap"}),
    "rigid_matrix": ("1.4 MPa", "rigid", {"cell.young_m"}),
    "infinite_points": ("points: 3", "points: .inf", {"sweep.poisson_m.points"}),
    "minus_infinity": ("30 GPa", "-.inf", {"cell.young_i"}),
    # units
    "unit_of_pressure": ("0.5 mm", "0.5 MPa", {"cell.gap"}),
    "unit_unknown": ("0.5 mm", "0.5 mmm", {"cell.gap"}),
    "unit_squared": ("0.5 mm", "0.5 mm^2", {"cell.gap"}),
    "unit_of_ratio": ("0.46", "0.46 m/m", {"cell.poisson_m"}),
    "unit_tower": ("0.5 mm", "0.5 m**9**9**9", {"cell.gap"}),
    "unit_alone": ("0.5 mm", "mm", {"cell.gap"}),
    "per_cent_of_length": ("0.5 mm", "5 %", {"cell.gap"}),
    "temperature_as_time": ("10 s", "10 K", {"prony.series.two.times.1"}),
    # ranges
    "gap_zero": ("0.5 mm", "0 mm", {"cell.gap"}),
    "gap_negative": ("0.5 mm", "-0.5 mm", {"cell.gap"}),
    "poisson_above_half": ("0.25", "0.51", {"cell.poisson_i"}),
    "poisson_minus_one": ("0.46", "-1", {"cell.poisson_m"}),
    "stop_of_range": ("stop: 0.4", "stop: 0.6", {"sweep.poisson_m"}),
    "axis_negative": ("[1e-2, 1e-1]", "[-1e-2, 1e-1]", {"sweep.gap_ratio"}),
    "axis_underflows": ("[1e-2, 1e-1]", "[1e-323, 1e-1]", {"sweep.gap_ratio"}),
    "tolerance_zero": ("tolerance: 1e-4", "tolerance: 0", {"reference.tolerance"}),
    "tolerance_too_fine": ("tolerance: 1e-4", "tolerance: 1e-40", {"reference.tolerance"}),
    "weights_above_one": ("[0.6, 0.3]", "[0.6, 0.6]", {"prony.series.two"}),
    "weights_without_times": ("[1 ms, 10 s]", "[1 ms]", {"prony.series.two"}),
    "times_descend": ("stop: 1e3 s", "stop: 1 ns", {"prony.times"}),
    "times_too_close": ("stop: 1e3 s", "stop: 1.0000000000000003 us", {"prony.times"}),
    "cylinder_too_narrow": ("  gap:", "  cylinder_radius: 5 mm\n  gap:", {"cell.cylinder_radius"}),
    # lists and products
    "axis_empty": ("[1e-2, 1e-1]", "[]", {"sweep.gap_ratio"}),
    "axis_repeats": ("[1e-2, 1e-1]", "[1e-2, 0.01]", {"sweep.gap_ratio"}),
    "axis_twice": ("  gap_ratio", "  poisson_m: [0.1]\n  gap_ratio", {"sweep.poisson_m"}),
    "axes_contradict": ("  gap_ratio", "  gap: [1 mm]\n  gap_ratio", {"sweep.gap_ratio"}),
    "models_repeat": ("[fsi, generatrix]", "[fsi, fsi]", {"models"}),
    "orders_fall": ("[2, 4]", "[4, 2]", {"convergence.orders"}),
    "product_huge": ("points: 3", "points: 9000000", {"sweep", "prony"}),
    "points_huge": ("points: 3", "points: 1e30", {"sweep.poisson_m.points"}),
    "range_without_width": ("stop: 0.4", "stop: 0", {"sweep.poisson_m"}),
    # keys
    "key_unknown": ("models:", "model:", {"model", "contributions"}),
    "key_of_block_unknown": ("  gap:", "  gpa:", {"cell.gpa", "cell.gap"}),
    "key_with_capital": ("title:", "Title:", {"Title", "title"}),
    "key_with_dot": ("contributions:", "cell.gap:", {"'cell.gap'"}),
    "key_with_escape": ("contributions:", '"\\e[2J":', {"\x1b[2J"}),
    "key_with_line": ("contributions:", '"a\\nb":', {"a\nb"}),
    "key_very_long": ("contributions:", f"? {'k' * 9000}\n:", {"k" * 9000}),
    "key_number": ("contributions:", "1:", {"1"}),
    "key_flag": ("contributions:", "true:", {"true"}),
    "key_list": ("contributions:", "? [1, 2]\n:", {"list"}),
    "key_repeats": ("contributions:", "title:", {"title"}),
    "merge_key": ("  radius_i: 7.5 mm", "  <<: {radius_i: 7.5 mm}", {"cell.<<", "cell.radius_i"}),
    "names_of_python": ("contributions:", "__class__:", {"__class__"}),
    "name_of_case_is_path": ("{base: {}}", "{../../x: {}}", {"convergence.cases.'../../x'"}),
    "name_of_series_is_path": ("{two: {", "{../two: {", {"prony"}),
    "material_is_path": ("prony:", "prony:\n  materials: [../../x]", {"prony.materials.0"}),
    "material_absent": ("prony:", "prony:\n  materials: [tar]", {"prony.materials.0"}),
    # names
    "model_unknown": ("[fsi, generatrix]", "[fsi, fea]", {"models.1"}),
    "model_is_reference": ("[fsi, generatrix]", "[fsi, fe]", {"models.1"}),
    "condition_unknown": ("[roller]", "[free]", {"reference.bc.0"}),
    "load_unknown": ("contributions:", "load: twist\ncontributions:", {"load"}),
    # text
    "title_very_long": ("A scene", "x" * 9000, {"title"}),
    "title_blank": ("A scene", "' '", {"title"}),
    "title_with_half_a_character": ("A scene", '"\\ud800"', {"title"}),
    # YAML itself
    "tab_as_indent": ("  gap: 0.5 mm", "\tgap: 0.5 mm", {"file"}),
    "indent_slips": ("  gap: 0.5 mm", "   gap: 0.5 mm", {"file"}),
    "bracket_open": ("[fsi, generatrix]", "[fsi, generatrix", {"file"}),
    "quote_open": ("A scene", "'A scene", {"file"}),
    "colon_in_text": ("A scene", "A scene: good", {"file"}),
    "alias_without_anchor": ("A scene", "*title", {"file"}),
    "anchor_into_itself": ("[fsi, generatrix]", "&a [*a]", {"file"}),
    "tag_of_python": ("A scene", "!!python/object/apply:os.getcwd []", {"title"}),
    "tag_of_python_name": ("A scene", "!!python/name:os.system", {"title"}),
    "tag_own": ("A scene", "!scene A scene", {"title"}),
    "tag_that_does_not_fit": ("A scene", "!!int A scene", {"file"}),
    "two_documents": ("cell:\n", "---\ncell:\n", {"file"}),
    "version_of_the_future": ("title:", "%YAML 9.9\n---\ntitle:", {"file"}),
    "control_character": ("A scene", "A \x07 scene", {"file"}),
}

LAUGHS = "a0: &a0 [x, x]\n" + "".join(
    f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 9)}]\n" for i in range(1, 12)
)

CHAIN = (
    GOOD + "a0: &a0 {k: x}\n" + "".join(f"a{i}: &a{i} {{k: *a{i - 1}}}\n" for i in range(1, 400))
)

FILES = {
    "empty": (b"", {"file"}),
    "only_remarks": (b"# nothing\n\n# here\n", {"file"}),
    "only_null": (b"~\n", {"file"}),
    "only_mark": (b"\xef\xbb\xbf", {"file"}),
    "one_word": (b"scene\n", {"file"}),
    "list_of_scenes": (b"- title: A\n- title: B\n", {"file"}),
    "json_list": (b'[{"title": "A"}]', {"file"}),
    "html": (b"<!DOCTYPE html>\n<html><body>404</body></html>\n", {"file"}),
    "conflict": (f"<<<<<<< HEAD\n{GOOD}=======\n{GOOD}>>>>>>> main\n".encode(), {"file"}),
    "picture": (b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR", {"file"}),
    "zeros": (bytes(4096), {"file"}),
    "latin_1": (GOOD.replace("A scene", "Szene f\u00fcr").encode("latin-1"), {"file"}),
    "utf_16_without_mark": (GOOD.encode("utf-16-le"), {"file"}),
    "utf_32": (GOOD.encode("utf-32"), {"file"}),
    "half_a_character": (GOOD.encode().replace(b"A scene", b"A \xc3"), {"file"}),
    "billion_laughs": (LAUGHS.encode(), {"file"}),
    "chain_of_aliases": (CHAIN.encode(), {"file"}),
    "deep_lists": (b"title: " + b"[" * 20000, {"file"}),
    "deep_mappings": ("".join(f"{' ' * i}a:\n" for i in range(400)).encode(), {"file"}),
    "too_large": (GOOD.encode() + b"# " + b"x" * 300_000, {"file"}),
    "cut_short": (GOOD.encode()[:200], {"file"}),
    "all_at_once": (
        b"""\
title: ''
cell: {radius_i: -1, gap: 0.5 MPa, young_i: 1e500, poisson_i: 0.7, young_m: soft, radius: 1}
sweep: {poisson_m: [0.1, 0.1], modulus_ratio: {start: 1}, twist: [1]}
models: [fsi, nonsense]
reference: {bc: loose, tolerance: 5}
convergence: {orders: [3, 2], cases: {a: {gap: -2}, B: {}}, repeats: 0}
contributions: maybe
load: twist
colour: red
""",
        {
            *("title", "cell.radius_i", "cell.gap", "cell.young_i", "cell.poisson_i"),
            *("cell.young_m", "cell.radius", "sweep.poisson_m", "sweep.modulus_ratio.stop"),
            *("sweep.modulus_ratio.points", "sweep.twist", "models.1", "reference.bc.0"),
            *("reference.tolerance", "convergence.orders", "convergence.cases.a.gap"),
            *("convergence.cases.B", "convergence.repeats", "contributions", "load", "colour"),
        },
    ),
}


def _edited(old: str, new: str) -> bytes:
    assert old in GOOD, old
    return GOOD.replace(old, new, 1).encode()


MALFORMED = {name: (_edited(old, new), fields) for name, (old, new, fields) in EDITS.items()}
MALFORMED |= FILES
