"""Readers written from the layouts alone, in NumPy."""

import json

import numpy as np


def grid(arrays):
    """The geometry in an NPZ of the program."""
    return json.loads(str(arrays["grid"]))


class Merl:
    """Linear between nodes: theta_h = 90 (i/90)^2, theta_d = i, phi_d = i degrees; marks of invalid cells are left out."""

    def __init__(self, path):
        assert tuple(np.fromfile(path, "<i4", 3)) == (90, 90, 180)
        self.values = np.fromfile(path, "<f8", offset=12).reshape(3, 90, 90, 180)[0] / 1500

    def __call__(self, wi, wo):
        h = wi + wo
        h /= np.linalg.norm(h, axis=-1, keepdims=True)
        theta_h, phi_h = np.arctan2(np.hypot(h[:, 0], h[:, 1]), h[:, 2]), np.arctan2(h[:, 1], h[:, 0])
        x = np.cos(phi_h) * wi[:, 0] + np.sin(phi_h) * wi[:, 1]
        y = np.cos(phi_h) * wi[:, 1] - np.sin(phi_h) * wi[:, 0]
        x, z = np.cos(theta_h) * x - np.sin(theta_h) * wi[:, 2], np.sin(theta_h) * x + np.cos(theta_h) * wi[:, 2]
        theta_d, phi_d = np.arctan2(np.hypot(x, y), z), np.arctan2(y, x) % np.pi
        ih, t = self.fraction(np.degrees(theta_h), 90 * (np.arange(90) / 90) ** 2)
        jd, u = self.fraction(np.degrees(theta_d), np.arange(90.0))
        kp, v = np.floor(np.degrees(phi_d)).astype(int) % 180, np.degrees(phi_d) % 1
        total = weights = 0.0
        for a, b, c in np.ndindex(2, 2, 2):
            w = np.where(a, t, 1 - t) * np.where(b, u, 1 - u) * np.where(c, v, 1 - v)
            value = self.values[np.minimum(ih + a, 89), np.minimum(jd + b, 89), (kp + c) % 180]
            w = np.where(value < 0, 0, w)
            total, weights = total + w * value, weights + w
        return total / weights

    @staticmethod
    def fraction(x, nodes):
        i = np.clip(np.searchsorted(nodes, x, side="right") - 1, 0, len(nodes) - 2)
        return i, np.clip((x - nodes[i]) / (nodes[i + 1] - nodes[i]), 0, 1)
