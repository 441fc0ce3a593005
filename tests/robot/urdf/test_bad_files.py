"""One hand-written file per rule: what is refused, with place and remedy, and what is repaired."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from sk120stiff.errors import InputError
from sk120stiff.robot import load_robot
from sk120stiff.robot.checks import check_robot
from sk120stiff.robot.urdf import captured_stderr

BAD = Path(__file__).resolve().parent.parent / "bad"

# file, line (0: the whole file), words of the message, words of the remedy
REFUSED = [
    ("attribute_twice.urdf", 13, "redefined", "XML editor"),
    ("attribute_without_quotes.urdf", 10, "not well-formed XML", "XML editor"),
    ("binary.urdf", 0, "a binary file", "URDF text"),
    ("blank.urdf", 1, "the file is empty", "Give a URDF"),
    ("child_of_two_trees.urdf", 23, "'fore' is the child of two joints", "one parent"),
    ("circle_without_root.urdf", 5, "'ab', 'bc', 'ca' form a closed loop", "closures:"),
    ("closed_loop.urdf", 24, "'elbow', 'shoulder', 'crank_joint', 'rod_joint' form", "closures:"),
    ("empty.urdf", 1, "the file is empty", "Give a URDF"),
    ("entity_bomb.urdf", 2, "entity definitions are never expanded", "Remove the <!DOCTYPE"),
    ("entity_from_file.urdf", 2, "entity definitions are never expanded", "Remove the <!DOCTYPE"),
    ("entity_unknown.urdf", 2, "Entity 'nbsp' not defined", "XML editor"),
    ("expression.urdf", 12, "'0 0 pi/2'> is an expression of xacro", "Give the .xacro"),
    ("joint_named_universe.urdf", 10, "'universe' is reserved", "Rename"),
    ("joint_spherical.urdf", 10, "it is spherical, with 3 degrees of freedom", "three revolute"),
    ("joint_to_itself.urdf", 16, "joins link 'upper' to itself", "two different links"),
    ("joint_twice.urdf", 23, "two joints of this name, the first in line 16", "Rename"),
    ("joint_two_parents.urdf", 21, "2 <parent> elements", "one parent"),
    ("joint_type_unknown.urdf", 10, "type 'helical' is unknown", "revolute, continuous"),
    ("joint_without_child.urdf", 16, "names no child link", "<child link="),
    ("joint_without_name.urdf", 16, "this joint has no name", "<joint name="),
    ("joint_without_parent.urdf", 10, "names no parent link", "<parent link="),
    ("joint_without_type.urdf", 10, "the joint has no type", "revolute, continuous"),
    ("lfs_pointer.urdf", 0, "a Git LFS pointer", "git lfs pull"),
    ("link_twice.urdf", 22, "two links of this name, the first in line 4", "Rename"),
    ("link_without_name.urdf", 22, "this link has no name", "<link name="),
    ("macro_calls_itself.xacro", 0, "xacro cannot expand this file: Recursion", "Mend"),
    ("macro_fails.xacro", 0, "no_such_property", "Mend"),
    ("mass_is_a_word.urdf", 5, "'heavy'> is not a number", "plain numbers"),
    ("mesh.stl", 0, "this is a mesh", "URDF that refers to it"),
    ("mimic_circle.urdf", 10, "'shoulder' → 'wrist' → 'elbow' → 'shoulder'", "Remove the <mimic>"),
    ("mimic_itself.urdf", 16, "'elbow' → 'elbow'", "Remove the <mimic>"),
    ("mimic_twice.urdf", 21, "several <mimic>", "keep one"),
    ("mimic_unknown.urdf", 16, "'sholder', which does not exist", "Did you mean 'shoulder'"),
    ("mimic_without_joint.urdf", 21, "<mimic> names no joint", "<mimic joint="),
    ("mjcf.urdf", 1, "an MJCF model", "outermost element is <robot>"),
    ("no_links.urdf", 2, "the robot has no links", "Add at least one"),
    ("not_xml.urdf", 1, "this is not XML", "Give a URDF"),
    ("number_is_a_word.urdf", 12, "'0 zero 0.5'> is not a number", "plain numbers"),
    ("number_is_nan.urdf", 12, "'0 0 nan'> is not a number", "plain numbers"),
    ("number_too_large.urdf", 12, "'0 0 1e999'> is too large", "plain numbers"),
    ("number_with_unit.urdf", 12, "'0 0 500mm'> is not a number", "plain numbers"),
    ("package_unknown.xacro", 0, "package 'no_such_package' was not found", "ROS_PACKAGE_PATH"),
    ("sdf.urdf", 2, "an SDF model", "outermost element is <robot>"),
    ("tag_not_closed.urdf", 21, "tag mismatch", "XML editor"),
    ("two_robots.urdf", 23, "more than one outermost element", "one <robot>"),
    ("two_roots.urdf", 22, "'base' (line 3), 'gripper' (line 22)", "fixed joint"),
    (
        "two_roots_by_typo.urdf",
        0,
        "2 links have no parent: 'base' (line 3), 'uper'",
        "mend the name",
    ),
    ("vector_of_four.urdf", 13, "'0 0 1 0'> holds 4 numbers, not 3", "plain numbers"),
    ("vector_of_two.urdf", 12, "'0 0.5'> holds 2 numbers, not 3", "plain numbers"),
    ("web_page.urdf", 1, "a web page", "outermost element is <robot>"),
]

# file, code of the finding, words of its place, words of its message
REPAIRED = [
    ("axis_missing.urdf", "axis_missing", "line 10, joint 'shoulder'", "standard says 1 0 0"),
    ("axis_not_unit.urdf", "axis_not_unit", "line 13, joint 'shoulder'", "length 2"),
    ("axis_zero.urdf", "joint_locked", "line 10, joint 'shoulder'", "its axis is zero"),
    ("bare_ampersand.urdf", "xml_syntax", "", "read as '&amp;'"),
    ("child_undeclared.urdf", "link_undeclared", "joint 'flange'", "child link 'tool0'"),
    ("comma_decimals.urdf", "number_syntax", "line 12", "as a decimal comma"),
    ("comma_separators.urdf", "number_syntax", "line 12", "as separators"),
    ("comment_with_hyphens.urdf", "xml_syntax", "", "contains '--'"),
    ("doctype_plain.urdf", "doctype", "line 2", "nothing is fetched"),
    ("effort_negative.urdf", "effort_negative", "line 14", "effort -10 is negative"),
    ("element_unknown.urdf", "unknown_element", "line 22", "<loop_joint>"),
    ("encoding_of_comments.urdf", "encoding", "line 2", "0xb9"),
    ("expanded_by_hand.urdf", "xacro_skipped", "", "xacro elements were ignored"),
    ("geometry_missing.urdf", "unknown_geometry", "line 6", "without <geometry>"),
    ("geometry_of_size_zero.urdf", "unknown_geometry", "line 6", "size ≤ 0"),
    ("geometry_unknown.urdf", "unknown_geometry", "line 6", "<cone>"),
    ("inertia_breaks_triangle.urdf", "inertia_triangle", "link 'upper'", "1 + 1 < 3"),
    ("inertia_missing.urdf", "inertia_missing", "line 5", "a point mass"),
    ("inertia_not_definite.urdf", "inertia_not_definite", "link 'upper'", "moments -1, 1, 3"),
    ("inertial_twice.urdf", "duplicate_element", "line 5", "the first one was used"),
    ("joint_floating.urdf", "joint_locked", "line 10", "with 6 degrees of freedom"),
    ("joint_floating.urdf", "locked_on_chain", "line 10", "between 'base' and 'fore'"),
    ("joint_named_as_link.urdf", "name_clash", "link 'fore'", "line 16"),
    ("joint_planar.urdf", "joint_locked", "line 10", "with 3 degrees of freedom"),
    ("joint_spherical_aside.urdf", "joint_locked", "joint 'lamp_joint'", "it is spherical"),
    ("joint_type_uppercase.urdf", "joint_type_spelling", "line 10", "'Revolute'"),
    ("lengths_in_millimetres.urdf", "units", "joint 'elbow'", "millimetres"),
    ("limit_all_zero.urdf", "effort_zero", "joint 'shoulder'", "effort limit is 0"),
    ("limit_all_zero.urdf", "limit_empty", "line 14", "taken as unlimited"),
    ("limit_all_zero.urdf", "velocity_zero", "joint 'shoulder'", "velocity limit is 0"),
    ("limit_infinite.urdf", "number_syntax", "line 14", "taken as absent"),
    ("limit_is_a_word.urdf", "number_syntax", "line 14", "'-1.57.'"),
    ("limit_missing.urdf", "limit_missing", "line 10", "taken as unlimited"),
    ("limit_of_continuous.urdf", "limit_ignored", "line 14", "continuous"),
    ("limit_reversed.urdf", "limit_empty", "line 14", "lower 2 ≥ upper -1"),
    ("limit_without_effort.urdf", "limit_missing", "line 14", "without effort"),
    ("limit_without_lower.urdf", "limit_missing", "line 14", "without lower"),
    ("limits_in_degrees.urdf", "units", "joint 'shoulder'", "degrees"),
    ("mass_in_grams.urdf", "units", "link 'upper'", "grams"),
    ("mass_missing.urdf", "mass_missing", "line 5", "taken as massless"),
    ("mass_negative.urdf", "mass_negative", "link 'upper'", "-1 kg"),
    ("mass_nowhere.urdf", "no_mass", "mass_nowhere.urdf", "gravity effects are impossible"),
    ("mass_zero.urdf", "mass_incomplete", "mass_zero.urdf", "1 of 2 moving joints"),
    ("mass_zero.urdf", "mass_zero", "link 'upper'", "mass of zero"),
    ("material_twice.urdf", "duplicate_material", "line 23, material 'red'", "the first one"),
    ("material_undefined.urdf", "unknown_material", "line 6", "'mauve'"),
    ("mesh_missing.urdf", "mesh_missing", "mesh_missing.urdf", "'arm_description' was not found"),
    ("mesh_outside_package.urdf", "mesh_missing", "", "leaves its package"),
    ("mimic_multiplier_zero.urdf", "mimic_zero", "joint 'elbow'", "stands at 0.3"),
    ("mimic_of_fixed.urdf", "joint_locked", "joint 'elbow'", "held still at 0.3"),
    ("mimic_on_fixed.urdf", "mimic_ignored", "joint 'wrist'", "does not move"),
    ("mimic_slide_of_turn.urdf", "mimic", "joint 'lift'", "lift = 1 · elbow + 0"),
    ("mimic_slide_of_turn.urdf", "mimic_units", "joint 'lift'", "multiplier's unit"),
    ("names_with_blanks.urdf", "name_blanks", "link 'fore'", "blanks"),
    ("nothing_moves.urdf", "nothing_moves", "", "no joint of this robot moves"),
    ("number_empty.urdf", "number_syntax", "line 12", "xyz is empty"),
    ("number_with_f.urdf", "number_syntax", "line 12", "the 'f' was ignored"),
    ("number_with_typographic_minus.urdf", "number_syntax", "line 12", "unusual characters"),
    ("parent_undeclared.urdf", "link_undeclared", "joint 'mount'", "parent link 'table'"),
    ("robot_without_name.urdf", "robot_name_missing", "line 2", "called 'robot_without_name'"),
    ("text_behind_the_end.urdf", "xml_syntax", "line 22", "text behind </robot>"),
    ("value_from_environment.urdf", "environment_value", "", "values of the environment"),
    ("velocity_negative.urdf", "velocity_negative", "line 14", "velocity -3 is negative"),
    ("visual_with_a_word.urdf", "visual_unreadable", "line 6", "'a b c'"),
    ("world_undeclared.urdf", "link_undeclared", "joint 'mount'", "parent link 'world'"),
    ("zero_outside_limits.urdf", "zero_outside_limits", "joint 'shoulder'", "outside the limits"),
]

# Read without a word: nothing in them is wrong.
HARMLESS_FILES = [
    "blank_before_declaration.urdf",
    "byte_order_mark.urdf",
    "encoding_utf16.urdf",
    "prefix_undeclared.urdf",
]


def files(folder: str) -> set[str]:
    return {path.name for path in (BAD / folder).iterdir()}


def test_every_file_has_its_line_in_the_tables() -> None:
    assert files("refused") == {row[0] for row in REFUSED}
    assert files("repaired") == {row[0] for row in REPAIRED} | set(HARMLESS_FILES)


@pytest.mark.parametrize(("name", "line", "what", "remedy"), REFUSED, ids=[r[0] for r in REFUSED])
def test_refused_with_place_and_remedy(name: str, line: int, what: str, remedy: str) -> None:
    with pytest.raises(InputError) as refusal:
        load_robot(BAD / "refused" / name)
    error = refusal.value
    assert error.exit_code == 2
    assert what in error.what
    assert error.where is not None
    assert name in error.where
    assert error.remedy is not None
    assert remedy in error.remedy
    if line:
        named = re.search(r"line (\d+)", error.where)
        assert named is not None
        assert int(named.group(1)) == line


@pytest.mark.parametrize("name", [row[0] for row in REFUSED])
def test_check_refuses_the_same(name: str) -> None:
    with pytest.raises(InputError):
        check_robot(BAD / "refused" / name)


@pytest.mark.parametrize(
    ("name", "code", "where", "message"), REPAIRED, ids=[f"{r[0]}-{r[1]}" for r in REPAIRED]
)
def test_repaired_and_said(name: str, code: str, where: str, message: str) -> None:
    report = check_robot(BAD / "repaired" / name)
    findings = [finding for finding in report.warnings if finding.code == code]
    assert findings, [str(finding) for finding in report.warnings]
    assert any(where in f.where and message in f.message for f in findings), findings


@pytest.mark.parametrize("name", HARMLESS_FILES)
def test_harmless_oddities_are_read_without_a_word(name: str) -> None:
    codes = {finding.code for finding in check_robot(BAD / "repaired" / name).warnings}
    assert codes <= {"singular_at_zero"}


def test_no_file_reaches_the_terminal_through_c_code() -> None:
    """Parsers in C++ may print; none of it may arrive on descriptor 2."""
    script = (
        "import sys, json\n"
        "from pathlib import Path\n"
        "from sk120stiff.errors import InputError\n"
        "from sk120stiff.robot.checks import check_robot\n"
        "out = {}\n"
        "for path in map(Path, sys.argv[1:]):\n"
        "    try: out[path.name] = len(check_robot(path).warnings)\n"
        "    except InputError as error: out[path.name] = str(error)\n"
        "print(json.dumps(out))\n"
    )
    paths = [p for p in sorted(BAD.rglob("*.urdf")) if "expanded" not in p.name]
    done = subprocess.run(
        [sys.executable, "-c", script, *map(str, paths)], capture_output=True, check=False
    )
    assert done.returncode == 0
    assert done.stderr == b""
    assert len(json.loads(done.stdout)) == len(paths)


def test_captured_stderr_catches_the_descriptor() -> None:
    with captured_stderr() as said:
        os.write(2, b"from C")
        assert said.text == "from C"
    assert said.text == "from C"
