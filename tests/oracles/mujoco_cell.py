"""MuJoCo on the user's own URDF: what touches, and what the motors must give; nothing of ours.

Meshes are handed over as STL, since MuJoCo reads no COLLADA; the tree, the shapes, the masses and
the limits are the file's. Pairs that touch with all joints at zero, or as near to it as the limits
allow, or wherever the arm stands, are found by MuJoCo itself.
"""

import xml.etree.ElementTree as ET
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import mujoco
import numpy as np
import trimesh

ALWAYS = 0.95  # share of random poses at which a pair touches that was drawn so


class MujocoCell:
    """An arm in MuJoCo, with a floor if there is one.

    Args:
        urdf: The file.
        folder: Where meshes may be written.
        samples: Joint values that tell which pairs touch wherever the arm stands.
        floor: Height of the ground in axes of the root [m].
        pinned: Pairs of bodies that a pin joins which the tree of the file does not have.
    """

    def __init__(
        self,
        urdf: Path,
        folder: Path,
        samples: Sequence[dict[str, float]],
        floor: float | None = None,
        pinned: Sequence[tuple[str, str]] = (),
    ) -> None:
        root = ET.parse(urdf).getroot()
        self.efforts, self.mimics, self.zero = {}, {}, {}
        for joint in root.iter("joint"):
            limit, mimic = joint.find("limit"), joint.find("mimic")
            if limit is not None:
                self.efforts[joint.get("name")] = float(limit.get("effort", 0.0)) or np.inf
                ends = float(limit.get("lower", 0.0)), float(limit.get("upper", 0.0))
                if joint.get("type") != "continuous" and ends[0] < ends[1]:
                    self.zero[joint.get("name")] = float(np.clip(0.0, *ends))
            if mimic is not None:
                rule = (float(mimic.get("multiplier", 1)), float(mimic.get("offset", 0)))
                self.mimics[joint.get("name")] = (mimic.get("joint"), *rule)
        for link in root.iter("link"):
            self._shapes(link, urdf, folder)
        for joint in root.iter("joint"):  # no copies of what follows
            for mimic in joint.findall("mimic"):
                joint.remove(mimic)
        extension = ET.SubElement(root, "mujoco")
        ET.SubElement(
            extension, "compiler", meshdir=str(folder), discardvisual="true", fusestatic="false",
            balanceinertia="true", boundmass="1e-9", boundinertia="1e-12", strippath="true",
        )  # fmt: skip
        spec = mujoco.MjSpec.from_string(ET.tostring(root, encoding="unicode"))
        if floor is not None:
            spec.worldbody.add_geom(
                type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0, 0, 1], pos=[0, 0, floor], name="floor"
            )
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)
        self.ignored = (
            self._always(samples)
            | {tuple(sorted(pair)) for pair in pinned}
            | {
                tuple(sorted(joint.find(end).get("link") for end in ("parent", "child")))
                for joint in root.iter("joint")
                if joint.find("parent") is not None
            }
        )

    def _shapes(self, link: ET.Element, urdf: Path, folder: Path) -> None:
        seen = link.findall("visual")
        if link.find("collision") is None:
            for visual in seen:
                visual.tag = "collision"
                for material in visual.findall("material"):
                    visual.remove(material)
        else:
            for visual in seen:
                link.remove(visual)
        for mesh in link.iter("mesh"):
            name = mesh.get("filename", "")
            stl = folder / f"{link.get('name')}_{len(list(folder.glob('*.stl')))}.stl"
            loaded = trimesh.load_scene(_found(name, urdf)).to_mesh()
            if name.lower().endswith(".dae"):
                loaded.apply_scale(_metres(_found(name, urdf)))
            loaded.export(stl)
            mesh.set("filename", stl.name)

    def _touching(self, values: dict[str, float]) -> set[tuple[str, str]]:
        for joint, (driver, factor, offset) in self.mimics.items():
            if driver in values:
                values = values | {joint: factor * values[driver] + offset}
        self.data.qpos[:] = 0.0
        for name, value in values.items():
            if mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_JOINT, name) >= 0:
                self.data.joint(name).qpos[0] = value
        mujoco.mj_forward(self.model, self.data)
        bodies = [
            tuple(int(self.model.geom_bodyid[g]) for g in contact.geom)
            for contact in self.data.contact[: self.data.ncon]
            if contact.dist < 0.0
        ]
        names = {
            tuple(sorted(self.model.body(b).name for b in pair)) for pair in bodies if all(pair)
        }
        floor = {
            ("floor", self.model.body(max(pair)).name)
            for pair in bodies
            if not all(pair) and self.model.body_weldid[max(pair)] != 0
        }
        return {(str(a), str(b)) for a, b in names | floor}

    def _always(self, samples: Sequence[dict[str, float]]) -> set[tuple[str, str]]:
        counts = Counter(pair for values in samples for pair in self._touching(values))
        at_zero = set(self._touching({name: self.zero.get(name, 0.0) for name in samples[0]}))
        return at_zero | {pair for pair, n in counts.items() if n >= ALWAYS * len(samples)}

    def contacts(self, values: dict[str, float]) -> set[tuple[str, str]]:
        """Bodies that touch at joint values [rad or m]."""
        return self._touching(values) - self.ignored

    def holding(
        self, values: dict[str, float], frame: str, point: np.ndarray, force: np.ndarray
    ) -> dict[str, float]:
        """What each joint must give under weight and a force at a point of a frame, root axes."""
        self._touching(values)
        model, data = self.model, self.data
        data.qvel[:] = data.qacc[:] = 0.0
        model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
        mujoco.mj_inverse(model, data)
        model.opt.disableflags &= ~int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
        body = model.body(frame).id
        at = data.xpos[body] + data.xmat[body].reshape(3, 3) @ point
        applied = np.zeros(model.nv)
        mujoco.mj_applyFT(model, data, force, np.zeros(3), at, body, applied)
        asked = data.qfrc_inverse - applied
        return {model.joint(k).name: float(asked[model.jnt_dofadr[k]]) for k in range(model.njnt)}


def _found(name: str, urdf: Path) -> Path:
    if "://" not in name:
        return (urdf.parent / name).resolve()
    tail = Path(name.split("://", 1)[1])
    for folder in urdf.parents:
        for candidate in (folder / tail, folder / Path(*tail.parts[1:])):
            if candidate.is_file():
                return candidate
    raise FileNotFoundError(name)


def _metres(path: Path) -> float:
    for element in ET.parse(path).iter():
        if element.tag.endswith("unit"):
            return float(element.get("meter", 1.0))
    return 1.0
