"""
When readings cannot decide
===========================

The floor is soft, but these poses were chosen for the springs. The answer lists every name that
fits, and the readings that would tell more. They are taken, and the names are weighed anew.
"""

import matplotlib.pyplot as plt

import sk120stiff as sk

robot = sk.load_robot("motoman_sk120")
base = sk.base_model(robot)
truth = base + sk.effect(robot, "base_rocking")
truth = truth.with_public({name: 1e7 for name in truth.names if "rocking" in name})
how = {"noise": sk.NoiseModel(10e-6), "schedule": sk.Schedule("ascending", levels=3)}

first = sk.simulate(truth, sk.plan(base, 20), seed=1, **how).measurements
among = sk.Options(only=("base_rocking", "link_bending", "joint_tilt", "base_sliding"))
before = sk.explain(base, first, options=among)
more = sk.simulate(truth, before.next_readings(), seed=2, **how).measurements
after = sk.explain(base, first + more, options=among)
print(before, after, sep="\n")

names = [before.findings[0].effect.id, *before.findings[0].alternatives]
plt.figure(figsize=(7.2, 2.4))
for k, answer in enumerate((before, after)):
    odds = answer.findings[0].evidence.odds
    chance = [odds.get(name, 0) for name in names]
    label = f"{answer.readings.n_readings} readings: {answer.verdict}"
    plt.barh([row + 0.4 * k for row in range(len(names))], chance, 0.38, label=label)
plt.yticks(range(len(names)), names)
plt.xlabel("probability")
plt.legend()
plt.show()
