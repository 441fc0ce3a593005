"""What stiffness under load can be asked for: names, shapes, and who computes what."""

from __future__ import annotations

#: Quantity → shape at one pose under one load; n coordinates, s of them soft.
QUANTITIES: dict[str, tuple[int | str, ...]] = {
    "coordinates": ("n",),
    "position": (3,),
    "rotation": (3, 3),
    "jacobian": (6, "n"),
    "condition": (),
    "K_gravity": ("s", "s"),
    "compliance_conventional": (6, 6),
    "K_C": ("s", "s"),
    "compliance": (3, 3),
    "compliance_enhanced": (6, 6),
    "values": (3,),
    "directions": (3, 3),
    "stiffness_class": (),
    "complementary_class": (),
    "critical": (),
    "stiffening": (),
    "deflection_conventional": (3,),
    "deflection_enhanced": (3,),
    "deflection_second_order": (3,),
    "deflection_equilibrium": (3,),
    "loaded_coordinates": ("n",),
}

#: The same whatever the load is.
BY_POSE = frozenset(list(QUANTITIES)[:7])
BY_LOAD = frozenset(QUANTITIES) - BY_POSE

#: What the compiled kernel computes.
COMPILED = frozenset(
    ("position", "rotation", "jacobian", "condition", "K_gravity", "K_C", "compliance")
    + ("values", "directions", "stiffness_class", "complementary_class", "critical")
    + ("deflection_enhanced",)
)


def shape_of(quantity: str, n: int, s: int) -> tuple[int, ...]:
    """Shape of a quantity at one pose under one load, for n coordinates, s of them soft."""
    sizes = {"n": n, "s": s}
    return tuple(k if isinstance(k, int) else sizes[k] for k in QUANTITIES[quantity])
