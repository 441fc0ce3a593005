"""Scenes that the browser opens, and the files that they stand in."""

import re

import numpy as np

from sk120stiff import load_robot
from sk120stiff.effects import effect
from sk120stiff.measurements import read_measurements
from sk120stiff.model import base_model
from sk120stiff.show import (
    Elastic,
    Scene,
    scene_of_model,
)
from sk120stiff.show.scene.scene import ScenePath
from tests.show.scenes import DATA, TWO_SLIDES, sk120, sk120_scene, springs
from tests.show.test_engine import with_effects


def bare_robot():
    text = re.sub(r"<visual>.*?</visual>", "", TWO_SLIDES, flags=re.DOTALL)
    return load_robot(text)


PATH = np.array([[1.5, -0.2, -0.3], [1.5, 0.0, -0.3], [1.5, 0.2, -0.3]])
SCENES = {
    "sk120": sk120_scene,
    "gantry": lambda: Scene(
        load_robot(TWO_SLIDES),
        Elastic.of_model(base_model(load_robot(TWO_SLIDES))),
        wrench=np.array([100.0, 50.0, -80.0, 5.0, -3.0, 2.0]),
    ),
    "gears": lambda: scene_of_model(
        with_effects("motoman_sk120", "gear_hardening:joint_2_l"),
        read_measurements(DATA),
        named=[effect(sk120(), "gear_hardening", "joint_2_l")],
    ),
    "path": lambda: Scene(
        sk120(),
        Elastic.of_model(springs()),
        path=ScenePath(
            PATH,
            PATH + [0.1, 0.0, 0.0],
            worst=1,
            said="weakest: 0.25 N/µm",
            freedom="free: x",
            middle=PATH.mean(axis=0),
            reach=np.array([0.2, 0.0, 0.0]),
            turns=True,
        ),
    ),
    "capsules": lambda: Scene(bare_robot(), Elastic.of_model(base_model(bare_robot()))),
}
