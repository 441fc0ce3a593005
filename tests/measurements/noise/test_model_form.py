"""Model-form error as a covariance: against the dense matrix, written down without the product."""

from dataclasses import replace

import numpy as np
import pytest

from sk120stiff.errors import InputError
from sk120stiff.measurements import EXACT, Measurements, ModelForm, NoiseModel

FORM = ModelForm(proportional=0.12, constant=15e-6)


def readings(*, moments: bool = False, zero: str = "shared") -> Measurements:
    """Three poses of four readings."""
    rng = np.random.default_rng(3)
    wrench = rng.normal(size=(12, 6)) * [300, 300, 300, 40, 40, 40]
    if not moments:
        wrench[:, 3:] = 0.0
    pose = np.repeat(np.arange(3), 4)
    return Measurements(
        pose=tuple("ABC"[k] for k in pose),
        joint_names=("a", "b"),
        joints=np.repeat(rng.normal(size=(3, 2)), 4, axis=0),
        wrench=wrench,
        displacement=rng.normal(size=(12, 3)) * 1e-4,
        robot="arm",
        zero=zero,
    )


def dense(data: Measurements, noise: NoiseModel) -> np.ndarray:
    """V (36, 36), row by row: E[(D_p f_i + b_p)(D_p f_j + b_p)ᵀ] = (τ₁² c² f_i·f_j + τ₀²) I."""
    full = np.zeros((12, 3, 12, 3))
    own, zero = noise.variances(data)
    d, f, m = data.displacement, data.wrench[:, :3], data.wrench[:, 3:]
    for i in range(12):
        for j in range(12):
            value = np.zeros(3)
            if data.zero_group[i] == data.zero_group[j]:
                value += zero[i]
            if data.pose[i] == data.pose[j]:
                rows = [k for k in range(12) if data.pose[k] == data.pose[i]]
                size = np.mean(np.sum(d[rows] ** 2, axis=1))
                for load in (f, m):
                    strength = np.mean(np.sum(load[rows] ** 2, axis=1))
                    if strength:
                        share = load[i] @ load[j] / strength
                        value += noise.form.proportional**2 * size * share
                value += noise.form.constant**2
            full[i, :, j, :] = np.diag(value + (own[i] if i == j else 0.0))
    return full.reshape(36, 36)


@pytest.mark.parametrize("moments", [False, True])
@pytest.mark.parametrize("zero", ["shared", "separate"])
def test_whitening_is_that_of_the_dense_covariance(moments, zero):
    data = readings(moments=moments, zero=zero)
    noise = NoiseModel(8e-6, zero=zero, form=FORM)
    V = dense(data, noise)
    x = np.random.default_rng(1).normal(size=(12, 3, 5))
    white = noise.whitener(data)
    got = white.apply(x)
    flat = x.reshape(36, 5)
    expected = flat.T @ np.linalg.solve(V, flat)
    assert got.T @ got == pytest.approx(expected, rel=1e-9, abs=1e-9 * np.abs(expected).max())
    assert white.logdet == pytest.approx(np.linalg.slogdet(V)[1], rel=1e-12)
    assert white.apply(x[:, :, 0]) == pytest.approx(got[:, 0])


def test_noise_is_the_lesser_part_along_the_directions_of_model_form_error():
    data = readings()
    noise = NoiseModel(8e-6, form=FORM)
    white = noise.whitener(data)
    root = np.linalg.cholesky(dense(data, NoiseModel(8e-6)))
    turned, first = white.outweighing(white.apply(root.reshape(12, 3, 36)))
    shares = (turned**2).sum(axis=1)  # of the noise, in units of the whole
    assert len(turned) and (shares < 0.5).all()
    assert white.noise_share == pytest.approx(shares.mean())
    assert set(first) <= {0, 12, 24}
    identity = white.outweighing(np.eye(36))[0]
    assert identity @ identity.T == pytest.approx(np.eye(len(first)))


def test_the_size_is_that_of_the_covariance():
    data = readings(moments=True)
    form = dense(data, NoiseModel(8e-6, form=FORM)) - dense(data, NoiseModel(8e-6))
    assert FORM.rms(data) == pytest.approx(np.sqrt(np.trace(form) / 36))


def test_exact_laws_leave_the_noise_alone():
    data = readings()
    x = np.random.default_rng(2).normal(size=(12, 3))
    noise = NoiseModel(8e-6)
    assert noise.form is EXACT and not noise.form
    assert noise.whitener(data).apply(x) == pytest.approx(
        replace(noise, form=ModelForm(1e-9, 0.0)).whitener(data).apply(x), rel=1e-6
    )


def test_scaling_noise_scales_all_of_it():
    data = readings()
    noise = NoiseModel(8e-6, form=FORM)
    assert noise.scaled(2.0).whitener(data).logdet == pytest.approx(
        noise.whitener(data).logdet + 36 * np.log(4.0)
    )


@pytest.mark.parametrize("size", [-0.1, np.nan, np.inf])
def test_a_size_is_zero_or_positive(size):
    with pytest.raises(InputError, match="model-form error"):
        ModelForm(proportional=size)
