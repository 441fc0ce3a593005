"""Shapes of a robot: what can be read is there, what cannot is said, nothing is raised."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

from sk120stiff.robot import load_robot
from sk120stiff.robot import visuals as module
from sk120stiff.robot.urdf import read_urdf
from sk120stiff.robot.visuals import Appearance, visuals

DAE = """<?xml version="1.0"?>{doctype}
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="cm" meter="0.01"/><up_axis>Y_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="9">0 0 0 100 0 0 0 100 0</float_array>
<technique_common><accessor source="#pa" count="3" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1" material="m"><input semantic="VERTEX" source="#v" offset="0"/>
<p>0 1 2</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node><instance_geometry url="#g">{material}
</instance_geometry></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>"""
BROKEN_MATERIAL = (
    '<bind_material><technique_common><instance_material symbol="m" target="#absent"/>'
    "</technique_common></bind_material>"
)


def robot(*geometries: str) -> str:
    shapes = "".join(
        f'<visual name="v{k}"><origin xyz="{k} 0 0"/><geometry>{shape}</geometry></visual>'
        for k, shape in enumerate(geometries)
    )
    return f'<robot name="r"><link name="base">{shapes}</link></robot>'


def seen(tmp_path: Path, *geometries: str) -> Appearance:
    path = tmp_path / "r.urdf"
    path.write_text(robot(*geometries))
    return visuals(read_urdf(path))


def mesh(address: str, more: str = "") -> str:
    return f'<mesh filename="{address}"{more}/>'


def test_primitives_keep_their_sizes(tmp_path: Path) -> None:
    found = seen(
        tmp_path,
        '<box size="1 2 3"/>',
        '<cylinder radius="0.1" length="2"/>',
        '<sphere radius="0.3"/>',
        '<capsule radius="0.1" length="0.5"/>',
    )
    assert [shape.kind for shape in found] == ["box", "cylinder", "sphere", "capsule"]
    assert [shape.size for shape in found] == [(1, 2, 3), (0.1, 2), (0.3,), (0.1, 0.5)]
    assert [shape.T_link_visual[0, 3] for shape in found] == [0, 1, 2, 3]
    assert found.findings == ()


@pytest.mark.parametrize("kind", ["stl", "obj", "ply", "off", "glb", "STL"])
def test_mesh_formats(tmp_path: Path, kind: str) -> None:
    trimesh.creation.box((1.0, 2.0, 3.0)).export(tmp_path / f"box.{kind.lower()}")
    (tmp_path / f"box.{kind.lower()}").rename(tmp_path / f"box.{kind}")
    (shape,) = seen(tmp_path, mesh(f"box.{kind}", ' scale="0.1 0.1 -0.1"'))
    assert shape.vertices is not None
    assert shape.faces is not None
    np.testing.assert_allclose(np.ptp(shape.vertices, axis=0), [0.1, 0.2, 0.3], atol=1e-6)
    assert trimesh.Trimesh(shape.vertices, shape.faces).volume > 0  # mirrored, not inside out


@pytest.mark.parametrize("material", ["", BROKEN_MATERIAL])
def test_collada_unit_is_applied_and_up_axis_ignored(tmp_path: Path, material: str) -> None:
    (tmp_path / "t.dae").write_text(DAE.format(doctype="", material=material))
    (shape,) = seen(tmp_path, mesh("t.dae"))
    assert shape.vertices is not None
    np.testing.assert_allclose(np.ptp(shape.vertices, axis=0), [1.0, 1.0, 0.0], atol=1e-9)


def test_a_bad_mesh_costs_only_itself(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    trimesh.creation.box((1.0, 1.0, 1.0)).export(tmp_path / "good.stl")
    (tmp_path / "empty.stl").write_bytes(b"")
    (tmp_path / "noise.stl").write_bytes(bytes(range(256)) * 3)
    (tmp_path / "liar.stl").write_bytes(bytes(80) + b"\xff\xff\xff\xff" + bytes(50))
    (tmp_path / "noise.dae").write_text("<COLLADA><oops></COLLADA>")
    (tmp_path / "noise.glb").write_bytes(b"glTF" + bytes(20))
    (tmp_path / "noise.obj").write_text("v 0 0 0\nf 1 2 3\n")
    (tmp_path / "nan.obj").write_text("v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    (tmp_path / "model.step").write_text("ISO-10303-21;")
    entities = '<!DOCTYPE COLLADA [<!ENTITY a "aaaa">]>'
    (tmp_path / "entities.dae").write_text(DAE.format(doctype=entities, material=""))
    bad = ["empty.stl", "noise.stl", "liar.stl", "noise.dae", "noise.glb", "noise.obj", "nan.obj"]
    bad += ["model.step", "entities.dae", "absent.stl", "/dev/zero", "http://example.org/a.stl"]
    bad += [f"{tmp_path}", "package://nowhere/a.stl"]
    found = seen(tmp_path, mesh("good.stl"), *map(mesh, bad), '<sphere radius="1"/>')
    assert [shape.name for shape in found] == ["v0", f"v{len(bad) + 1}"]
    assert len(found.findings) == len(bad)
    for address, finding in zip(bad, found.findings, strict=True):
        assert finding.code == "mesh_missing"
        assert address in finding.message
        assert "line 1, link 'base'" in finding.where

    monkeypatch.setattr(module, "MAX_MESH_BYTES", 10)
    assert "more than" in seen(tmp_path, mesh("good.stl")).findings[0].message


def test_colours_come_from_the_file() -> None:
    text = (
        '<robot name="r"><material name="red"><color rgba="1 0 0 0.5"/></material><link name="a">'
        '<visual><geometry><box size="1 1 1"/></geometry><material name="red"/></visual>'
        '<visual><geometry><box size="1 1 1"/></geometry><material name="own">'
        '<color rgba="0 2 0 1"/></material></visual>'
        '<visual><geometry><box size="1 1 1"/></geometry></visual></link></robot>'
    )
    assert [shape.rgba for shape in visuals(read_urdf(text))] == [
        (1.0, 0.0, 0.0, 0.5),
        (0.0, 1.0, 0.0, 1.0),
        None,
    ]


def test_a_loaded_robot_and_its_document_look_the_same() -> None:
    robot = load_robot("motoman_sk120")
    assert len(visuals(robot)) == len(visuals(robot.document)) > 10
    assert {shape.link for shape in visuals(robot)} <= set(robot.frames)
