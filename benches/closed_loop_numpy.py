#!/usr/bin/env python3
"""A closed loop of the same kind as `tandem replay --mode closed`, in numpy, as a peer for its speed.

    python3 benches/closed_loop_numpy.py [SECONDS]

Needs numpy. What one simulated second holds is that of a session with sonars:

- a unicycle moved on exactly, 50 times;
- 25 firings of two sonars, each a cone of 21 rays against the 10 segments of a room;
- 100 predictions and updates of an extended Kalman filter of nine states by the gyro, 50 by the wheels;
- 10 steps of a controller: the points heard in the last five seconds as discs, 20 rays through them, and
  the speed brought down to what is free.

It leaves out what the program does besides: faces, confirmation and carving of points, attitude, the law,
the sets, hashing, reading and comparing with the log. So the figure is generous to numpy. Arrays are
used wherever there is more than one of a thing.
"""

import sys
import time

import numpy as np

ROOM = np.array([[0, 0], [8, 0], [8, 6], [5, 6], [5, 4.5], [3, 4.5], [3, 6], [0, 6], [0, 3], [-1, 3]], float)
FROM, ALONG = ROOM, np.roll(ROOM, -1, axis=0) - ROOM
FAN = np.radians(np.linspace(-12.5, 12.5, 21))
BEARINGS = np.radians([90, 50, 30, 10, -10, -30, -50, -90, -90, -130, -150, -170, 170, 150, 130, 90])
RADIUS_M, GUARD_M, PERIOD_S = 0.354, 0.05, 0.1


def ranges(at, angles):
    """Distance from a point along each angle to the nearest segment, metres."""
    rays = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    cross = rays[:, :1] * ALONG[:, 1] - rays[:, 1:] * ALONG[:, 0]
    to = FROM - at
    with np.errstate(divide="ignore", invalid="ignore"):
        ahead = (to[:, 0] * ALONG[:, 1] - to[:, 1] * ALONG[:, 0]) / cross
        share = (to[:, 0] * rays[:, 1:] - to[:, 1] * rays[:, :1]) / cross
    hit = (ahead > 0) & (share >= 0) & (share <= 1)
    return np.where(hit, ahead, np.inf).min(axis=1)


def free(points, at, angles):
    """Free travel of the disc from a point along each angle, metres."""
    rays = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    to = points - at
    forward = rays @ to.T
    aside = rays[:, :1] * to[:, 1] - rays[:, 1:] * to[:, 0]
    chord = RADIUS_M**2 - aside**2
    met = (chord > 0) & (forward > 0)
    return np.where(met, forward - np.sqrt(np.where(met, chord, 0)), np.inf).min(axis=1)


class Filter:
    """x, y, heading, v, omega, gyro bias, turn gain, travel, turn."""

    def __init__(self, pose):
        self.x = np.zeros(9)
        self.x[:3] = pose
        self.p = np.diag([1e-12, 1e-12, 1e-12, 0.25, 2.25, 0.0025, 0.0025, 1e-8, 1e-8])
        self.q = np.diag([0, 0, 0, 0.25, 2.25, 1e-10, 1e-8, 1e-9, 1e-9])

    def predict(self, dt):
        x = self.x
        heading = x[2] + 0.5 * x[4] * dt
        c, s = np.cos(heading), np.sin(heading)
        f = np.eye(9)
        f[0, 2], f[1, 2] = -x[3] * dt * s, x[3] * dt * c
        f[0, 3], f[1, 3] = dt * c, dt * s
        f[2, 4], f[7, 3], f[8, 4], f[8, 6] = dt, dt, (1 + x[6]) * dt, x[4] * dt
        x[:3] += [x[3] * dt * c, x[3] * dt * s, x[4] * dt]
        x[7:] += [x[3] * dt, (1 + x[6]) * x[4] * dt]
        self.p = f @ self.p @ f.T + self.q * dt

    def update(self, h, innovation, variance):
        spread = self.p @ h
        gain = spread / (h @ spread + variance)
        self.x += gain * innovation
        rest = np.eye(9) - np.outer(gain, h)
        self.p = rest @ self.p @ rest.T + variance * np.outer(gain, gain)


def run(seconds, rng):
    pose = np.array([2.0, 2.0, 0.3])
    command = np.zeros(2)
    filter_ = Filter(pose)
    gyro_h, travel_h, turn_h = np.zeros(9), np.zeros(9), np.zeros(9)
    gyro_h[[4, 5]], travel_h[7], turn_h[8] = 1, 1, 1
    points, heard_at = np.zeros((0, 2)), np.zeros(0)
    travelled = turned = 0.0
    for tick in range(round(seconds * 100)):
        now = tick * 0.01
        filter_.predict(0.01)
        gyro = command[1] + rng.normal(0, 0.005)
        filter_.update(gyro_h, gyro - filter_.x[4] - filter_.x[5], 2.5e-5)
        if tick % 2 == 0:
            half = 0.5 * command[1] * 0.02
            chord = command[0] * 0.02 * np.sinc(half / np.pi)
            pose += [chord * np.cos(pose[2] + half), chord * np.sin(pose[2] + half), 2 * half]
            travelled += command[0] * 0.02
            turned += 2 * half
            filter_.update(travel_h, travelled - filter_.x[7], 1e-6)
            filter_.update(turn_h, turned - filter_.x[8], 1e-5)
        if tick % 4 == 0:
            for sonar in ((tick // 4) % 8, 8 + (tick // 4) % 8):
                nearest = ranges(pose[:2], pose[2] + BEARINGS[sonar] + FAN).min()
                if nearest < 5:
                    nearest *= 1 + rng.normal(0, 0.01)
                    arc = filter_.x[2] + BEARINGS[sonar] + np.radians([-10, -5, 0, 5, 10])
                    arc = filter_.x[:2] + nearest * np.stack([np.cos(arc), np.sin(arc)], axis=1)
                    points = np.concatenate([points, arc])
                    heard_at = np.concatenate([heard_at, np.full(5, now)])
        if tick % 10 == 0:
            # As many as the program remembers on average.
            young = heard_at > now - 5
            points, heard_at = points[young][-200:], heard_at[young][-200:]
            wanted = np.array([0.4, 0.6 * np.sin(0.5 * now)])
            angles = filter_.x[2] + np.linspace(-0.6, 0.6, 20)
            ahead = free(points, filter_.x[:2], angles).min() if len(points) else 0.0
            command = wanted if ahead / PERIOD_S > wanted[0] + GUARD_M else np.array([0.0, 0.8])
    return pose


def main():
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 20.0
    run(1.0, np.random.default_rng(0))
    rates = []
    for seed in range(5):
        start = time.process_time()
        run(seconds, np.random.default_rng(seed))
        rates.append(seconds / (time.process_time() - start))
    print(f"numpy {np.__version__}: {sorted(rates)[2]:.0f} x real time")


if __name__ == "__main__":
    main()
