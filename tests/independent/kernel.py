"""The fast non-smooth stepper behind `generator.py`: event-located RK4 in numba, friction set-valued.

The state is (y, v, y2, v2, s_dahl, s_lugre, s_bouc_wen, s_relaxation, z behind a low-pass). A step is taken along one
smooth branch, which four modes name: contact (-1, 0 inside the play, +1), the sign of z' and the sign of y' (0: it
sticks), and the contact of a second link behind a play of its own. If a step leaves its branch, bisection finds where; the
modes are decided anew there and the rest of the step follows. Sticking is exact: the velocity is held until the torque needed
exceeds what friction can give. At zero velocity the modes are the one
solution of

    J a + F_joint Sgn(a - x'') + F_ground Sgn(a)  contains  R,

R being all other torque [N m]: the left side is monotone in a, so there is one.
"""

from __future__ import annotations

import numpy as np

try:
    from numba import njit
except ImportError:  # the fast generator is for development only

    def njit(**_options):
        """Stands in for numba's decorator where numba is missing; calling what it decorates says what to do."""

        def decorate(function):
            def missing(*_args):
                raise ImportError('the record generator needs numba, not installed: pip install "jaxbacklash[dev]"')

            return missing

        return decorate


# Columns of the parameter vector. Zero is the null value of every one, except where `generator.pack` says otherwise.
(
    J, B, K, C, G, T0, K1, K1_REST, Z0, ASYM, K3, CC, CHI, TC, S_TC, S_TS, S_VS, TG, DRAG, RIPPLE, RIPPLE_N, RIPPLE_PHI,
    D_SIGMA, D_FC, L_S0, L_S1, L_S2, L_FC, L_FS, L_VS, W_SIGMA, W_FC, W_N, W_BETA, J2, K2, C2, GAP_RATE, K_RATE,
    DIST, DIST_W, DIST_PHI, SPEED_K, PHI0, ERROR, ERROR_M, ERROR_PSI, MU, KR, TAU_R, POWER, POWER_D0, C_RATE, DRY_RATE,
    CC_PULLS, CHI_PULLS, FILTER, PULSE, PULSE_W, STOP_K, STOP_AT, DETENT, DETENT_W, RUMBLE, STEP, STEP_T, ONE_WAY, FILM, FILM_H,
    B2, SIZE,
) = range(71)  # fmt: skip
STATES = 9
RUMBLING = 2.0 * np.pi * np.array([3.1, 4.7, 7.3, 11.2, 16.9])
"""Angular frequencies of a rumble [rad/s], of which none is a multiple of another."""
_EVENTS_PER_STEP = 60


@njit(cache=True)
def _path(t, coefficients, grid):
    """x, x', x'' at t from quintic pieces (n, 6) on a uniform grid [s]."""
    i = min(int(t / grid), coefficients.shape[0] - 1)
    u = t - i * grid
    a = coefficients[i]
    x = a[0] + u * (a[1] + u * (a[2] + u * (a[3] + u * (a[4] + u * a[5]))))
    dx = a[1] + u * (2 * a[2] + u * (3 * a[3] + u * (4 * a[4] + u * 5 * a[5])))
    ddx = 2 * a[2] + u * (6 * a[3] + u * (12 * a[4] + u * 20 * a[5]))
    return x, dx, ddx


@njit(cache=True)
def _middle(x, p):
    """The middle of the play [rad] with the base at x [rad]."""
    return p[Z0] + (p[ERROR] * np.sin(p[ERROR_M] * x + p[ERROR_PSI]) if p[ERROR] != 0.0 else 0.0)


@njit(cache=True)
def _half(t, p):
    """Half the play [rad] at t [s]: it wears, or it has grown all at once."""
    return p[B] / 2 * (1 + p[GAP_RATE] * t) * (1 + p[STEP] if t > p[STEP_T] else 1.0)


@njit(cache=True)
def _outside(t, y, v, z, w, x, contact, p):
    """Torque [N m] of what no law of the catalogue describes, but for what stiffens a contact."""
    total = 0.0
    if p[STOP_K] != 0.0 and y > p[STOP_AT]:
        total -= p[STOP_K] * (y - p[STOP_AT])
    if p[DETENT] != 0.0:
        total -= p[DETENT] * y / p[DETENT_W] * np.exp(0.5 - 0.5 * (y / p[DETENT_W]) ** 2)
    if p[RUMBLE] != 0.0:
        for i in range(RUMBLING.size):
            total += p[RUMBLE] * np.sin(RUMBLING[i] * t + i * i)
    if p[ONE_WAY] != 0.0 and w > 0.0:
        total -= p[ONE_WAY] * w
    if p[FILM] != 0.0:
        away = 0.0 if contact != 0 else _half(t, p) - np.abs(z - _middle(x, p))
        total -= p[FILM] * w * np.exp(-away / p[FILM_H])
    return total


@njit(cache=True)
def _dry(t, p):
    """Dry friction at t [s] over what it is at 0."""
    return max(1 + p[DRY_RATE] * t, 0.0)


@njit(cache=True)
def _slip_friction(t, z, w, x, contact, p):
    """The size of the joint's sliding friction [N m] at relative angle z [rad] and speed w [rad/s]."""
    size = p[TC]
    if p[S_TS] != 0.0 or p[S_TC] != 0.0:
        size += p[S_TC] + (p[S_TS] - p[S_TC]) * np.exp(-((w / p[S_VS]) ** 2))
    if p[MU] != 0.0 and contact != 0:
        depth = z - _middle(x, p) - contact * _half(t, p)
        size += p[MU] * np.abs(p[K] * (1 + p[K_RATE] * t) * depth)
    return size * _dry(t, p)


@njit(cache=True)
def _stretched(s, modes, p):
    """How far the second link's spring is stretched [rad], the link seen from the first one."""
    behind = s[2] - s[0]
    if p[B2] == 0.0:
        return behind
    return 0.0 if modes[3] == 0 else behind - modes[3] * p[B2] / 2


@njit(cache=True)
def _torque(t, s, p, modes, x, dx, force, rate):
    """All torque on the link but set-valued friction [N m]; writes the rates of the hysteresis states into `rate`."""
    y, v = s[0], s[1]
    z, w = y - x, v - dx
    contact, joint, ground = modes[0], modes[1], modes[2]
    speed = joint * w  # |z'| on this branch
    total = force - p[C] * (1 + p[C_RATE] * t) * w + p[T0] - p[K1] * (z - p[K1_REST]) - p[DRAG] * ground * v * v
    if contact != 0:
        depth = z - _middle(x, p) - contact * _half(t, p)
        spring = p[K] * (1 + p[K_RATE] * t) * depth
        stiffness = p[K] * (1 + p[K_RATE] * t) * (1 + contact * p[ASYM]) + p[SPEED_K] * speed
        if p[PULSE] != 0.0:
            stiffness += p[K] * p[PULSE] * np.sin(p[PULSE_W] * t)
        if p[CC_PULLS] != 0.0 and p[CHI_PULLS] != 0.0:
            damper = (p[CC] + p[CHI] * contact * depth) * w
        else:  # spring and damper push the link out of the contact, or nothing does
            first, second = p[CC] * w, p[CHI] * contact * depth * w
            if p[CC_PULLS] == 0.0 and contact * (spring + first) < 0.0:
                first = -spring
            if p[CHI_PULLS] == 0.0 and contact * (spring + second) < 0.0:
                second = -spring
            damper = first + second
        total -= stiffness * depth + p[K3] * depth**3 + damper
        if p[POWER] != 1.0:
            total -= spring * ((np.abs(depth) / p[POWER_D0]) ** (p[POWER] - 1) - 1)
    total += _outside(t, y, v, z, w, x, contact, p)
    if p[G] != 0.0:
        total += p[G] * np.sin(y + p[PHI0])
    if p[RIPPLE] != 0.0:
        total += p[RIPPLE] * np.sin(p[RIPPLE_N] * y + p[RIPPLE_PHI])
    if p[DIST] != 0.0:
        total += p[DIST] * np.sin(p[DIST_W] * t + p[DIST_PHI])
    if p[K2] != 0.0:
        total += p[K2] * _stretched(s, modes, p) + p[C2] * (s[3] - v)
    if p[D_SIGMA] != 0.0:
        rate[4] = p[D_SIGMA] * (w - speed * s[4] / p[D_FC])
        total -= s[4] * _dry(t, p)
    if p[L_S0] != 0.0:
        g = p[L_FC] + (p[L_FS] - p[L_FC]) * np.exp(-((w / p[L_VS]) ** 2))
        rate[5] = w - p[L_S0] * speed * s[5] / g
        total -= (p[L_S0] * s[5] + p[L_S1] * rate[5]) * _dry(t, p) + p[L_S2] * w
    if p[W_SIGMA] != 0.0:
        full = np.abs(s[6] / p[W_FC]) ** p[W_N]
        rate[6] = p[W_SIGMA] * (w - full * (p[W_BETA] * speed * np.sign(s[6]) + (1 - p[W_BETA]) * w))
        total -= s[6] * _dry(t, p)
    if p[KR] != 0.0:
        rate[7] = p[KR] * w - s[7] / p[TAU_R]
        total -= s[7]
    if p[FILTER] != 0.0:
        rate[8] = (z - s[8]) / p[FILTER]
    return total


@njit(cache=True)
def _rates(t, s, p, modes, base, push, grid, rate):
    """The state's rate of change on the branch `modes`, into `rate`."""
    x, dx, ddx = _path(t, base, grid)
    force = _path(t, push, grid)[0]
    total = _torque(t, s, p, modes, x, dx, force, rate)
    rate[0] = s[1]
    if modes[1] == 0:
        rate[1] = ddx
    elif modes[2] == 0:
        rate[1] = 0.0
    else:
        at_joint = modes[1] * _slip_friction(t, s[0] - x, s[1] - dx, x, modes[0], p)
        rate[1] = (total - at_joint - modes[2] * (p[TG] * _dry(t, p))) / p[J]
    if p[K2] != 0.0:
        rate[2] = s[3]
        rate[3] = -(p[K2] * _stretched(s, modes, p) + p[C2] * (s[3] - s[1])) / p[J2]


@njit(cache=True)
def _rk4(t, s, h, p, modes, base, push, grid, work, out):
    """One classical Runge-Kutta step of h [s] from s into out; work (5, STATES) is scratch."""
    _rates(t, s, p, modes, base, push, grid, work[0])
    for i in range(STATES):
        work[4, i] = s[i] + h / 2 * work[0, i]
    _rates(t + h / 2, work[4], p, modes, base, push, grid, work[1])
    for i in range(STATES):
        work[4, i] = s[i] + h / 2 * work[1, i]
    _rates(t + h / 2, work[4], p, modes, base, push, grid, work[2])
    for i in range(STATES):
        work[4, i] = s[i] + h * work[2, i]
    _rates(t + h, work[4], p, modes, base, push, grid, work[3])
    for i in range(STATES):
        out[i] = s[i] + h / 6 * (work[0, i] + 2 * work[1, i] + 2 * work[2, i] + work[3, i])


@njit(cache=True)
def _left(t, s, p, modes, base, push, grid, scratch, out):
    """Which of the four modes no longer hold at (t, s), into out (4,); returns whether any."""
    x, dx, ddx = _path(t, base, grid)
    force = _path(t, push, grid)[0]
    e, w = s[0] - x - _middle(x, p), s[1] - dx
    half = _half(t, p)
    out[0] = np.abs(e) > half if modes[0] == 0 else modes[0] * e < half
    out[1] = modes[1] * w < 0
    out[2] = modes[2] * s[1] < 0
    if modes[1] == 0:
        total = _torque(t, s, p, modes, x, dx, force, scratch)
        held = _slip_friction(t, s[0] - x, 0.0, x, modes[0], p)
        out[1] = np.abs(total - modes[2] * (p[TG] * _dry(t, p)) - p[J] * ddx) > held
    if modes[2] == 0:
        total = _torque(t, s, p, modes, x, dx, force, scratch)
        out[2] = np.abs(total - modes[1] * _slip_friction(t, s[0] - x, w, x, modes[0], p)) > p[TG] * _dry(t, p)
    behind = s[2] - s[0]
    out[3] = p[B2] != 0.0 and (np.abs(behind) > p[B2] / 2 if modes[3] == 0 else modes[3] * behind < p[B2] / 2)
    return out[0] or out[1] or out[2] or out[3]


@njit(cache=True)
def _decide_friction(t, s, p, modes, base, push, grid, scratch, joint_zero, ground_zero):
    """Choose the friction modes at zero velocity: stick if friction can hold, else the direction of the rest's pull."""
    x, dx, ddx = _path(t, base, grid)
    if joint_zero and ground_zero and ddx == 0.0:
        ddx = _path(t + grid, base, grid)[2]  # a base about to move
    force = _path(t, push, grid)[0]
    if ground_zero:
        s[1] = 0.0
    elif joint_zero:
        s[1] = dx
    rest = _torque(t, s, p, modes, x, s[1] if joint_zero else dx, force, scratch)
    held, ground = _slip_friction(t, s[0] - x, 0.0, x, modes[0], p), p[TG] * _dry(t, p)
    if joint_zero and ground_zero:
        away = np.sign(ddx)
        if ground > 0 and np.abs(rest + held * away) <= ground:
            modes[1], modes[2] = (-1 if away > 0 else 1), 0
        elif held > 0 and np.abs(rest - p[J] * ddx - ground * away) <= held:
            modes[1], modes[2] = 0, (1 if away >= 0 else -1)
        elif rest - held - ground > p[J] * max(0.0, ddx):
            modes[1], modes[2] = 1, 1
        elif rest + held + ground < p[J] * min(0.0, ddx):
            modes[1], modes[2] = -1, -1
        else:
            modes[1], modes[2] = (-1 if away > 0 else 1), (1 if away > 0 else -1)
    elif joint_zero:
        pull = rest - modes[2] * ground - p[J] * ddx
        modes[1] = 0 if held > 0 and np.abs(pull) <= held else (1 if pull > 0 else -1)
    elif ground_zero:
        pull = rest - modes[1] * _slip_friction(t, s[0] - x, s[1] - dx, x, modes[0], p)
        modes[2] = 0 if ground > 0 and np.abs(pull) <= ground else (1 if pull > 0 else -1)


@njit(cache=True)
def _decide(t, s, p, modes, left, base, push, grid, scratch):
    """New modes at a switch, given which were left."""
    if left[0]:
        x = _path(t, base, grid)[0]
        e = s[0] - x - _middle(x, p)
        modes[0] = (1 if e > 0 else -1) if modes[0] == 0 else 0
    if left[3]:
        modes[3] = (1 if s[2] > s[0] else -1) if modes[3] == 0 else 0
    if left[1] or left[2]:
        joint_zero, ground_zero = left[1] or modes[1] == 0, left[2] or modes[2] == 0
        _decide_friction(t, s, p, modes, base, push, grid, scratch, joint_zero, ground_zero)


@njit(cache=True)
def run(start, t_out, step, p, base, push, grid):
    """States (n, STATES) and contact modes (n,) at t_out (n,) [s], from t = 0 and `start` (STATES,).

    step: the longest step [s]; p: the parameter vector (SIZE,);
    base, push: quintic coefficients (m, 6) of x(t) [rad] and of the force on the link [N m] on a grid of `grid` [s].
    """
    states, contact = np.empty((t_out.size, STATES)), np.empty(t_out.size, np.int64)
    work, scratch, trial, s = np.zeros((5, STATES)), np.zeros(STATES), np.zeros(STATES), start.copy()
    modes, left = np.zeros(4, np.int64), np.zeros(4, np.bool_)
    x, dx, _ = _path(0.0, base, grid)
    e = s[0] - x - _middle(x, p)
    if np.abs(e) > p[B] / 2:
        modes[0] = 1 if e > 0 else -1
    if np.abs(s[2] - s[0]) > p[B2] / 2:
        modes[3] = 1 if s[2] > s[0] else -1
    modes[1], modes[2] = np.int64(np.sign(s[1] - dx)), np.int64(np.sign(s[1]))
    _decide_friction(0.0, s, p, modes, base, push, grid, scratch, modes[1] == 0, modes[2] == 0)
    t = 0.0
    for n in range(t_out.size):
        steps = max(1, int(np.ceil((t_out[n] - t) / step - 1e-6)))
        begin, h = t, (t_out[n] - t) / steps
        for k in range(steps):
            end, events = begin + (k + 1) * h, 0
            while end - t > 1e-14:
                _rk4(t, s, end - t, p, modes, base, push, grid, work, trial)
                if not _left(end, trial, p, modes, base, push, grid, scratch, left) or events == _EVENTS_PER_STEP:
                    t = end
                    s[:] = trial
                    break
                low, high = 0.0, end - t
                for _ in range(60):
                    middle = (low + high) / 2
                    if high - low < 1e-17 or middle in (low, high):
                        break
                    _rk4(t, s, middle, p, modes, base, push, grid, work, trial)
                    if _left(t + middle, trial, p, modes, base, push, grid, scratch, left):
                        high = middle
                    else:
                        low = middle
                _rk4(t, s, high, p, modes, base, push, grid, work, trial)
                t += high
                _left(t, trial, p, modes, base, push, grid, scratch, left)
                s[:] = trial
                _decide(t, s, p, modes, left, base, push, grid, scratch)
                events += 1
            t = end
        states[n], contact[n] = s, modes[0]
    return states, contact
