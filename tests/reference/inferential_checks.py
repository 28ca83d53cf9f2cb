"""Checks of docs/methods/inferential.md without firmware: published vectors, the algebra of Frau's chapter 4 (with its
misprints repaired), and both discrete forms. Run by inferential_reference.py. Each check prints its largest difference.
"""

import numpy as np
from inferential_laws import (
    CASCADE,
    CLF,
    CONVENTIONAL,
    EULER,
    JOINT,
    Loop,
    continuous,
    stepped,
    transition_rate,
)

TEN_SECONDS = 10 / 3600
LAWS = (CONVENTIONAL, CASCADE, CLF)
# Model plant and gains of the vectors.
A, B, GAINS = (1.0, 2.0), (1.0, 0.5), dict(kc=2.0, kc2=4.0, ko=20.0)
TIMES = (0.05, 0.1, 0.5, 1.0, 2.0)
CONVENTIONAL_Y = (0.0298310, 0.0379664, 0.0204352, 0.0075186, 0.0010175)
TWO = {  # y1, y2, e2, u at TIMES
    CASCADE: [
        (0.029005, -0.016991, 0.014089, -0.718308),
        (0.035701, -0.078597, 0.016718, -0.969504),
        (0.014445, -0.721109, 0.004228, -1.037301),
        (0.004332, -1.491337, 0.000572, -1.009808),
        (0.000519, -2.998961, 0.000010, -1.001059),
    ],
    CLF: [
        (0.028235, -0.018529, 0.012493, -0.741813),
        (0.033759, -0.082482, 0.012502, -0.990945),
        (0.012604, -0.724792, -0.004346, -1.029074),
        (0.005007, -1.489986, -0.003569, -1.007884),
        (0.001150, -2.997701, -0.000896, -1.001656),
    ],
}
# By step of 10 s: (column of stepped(), time, value)
EULER_VECTORS = {
    CONVENTIONAL: [(0, 0.1, 0.038363), (0, 1, 0.007477)],
    CASCADE: [(0, 0.1, 0.036090), (0, 0.5, 0.014371), (0, 1, 0.004298), (2, 1, 0.000560)],
    CLF: [(0, 0.1, 0.034128), (0, 0.5, 0.012533), (0, 1, 0.004986), (2, 1, -0.003567)],
}
DAMPING = {
    None: (1.25, 1.0607, 1.0, 1.0607, 1.25),
    1: (1.5, 1.4142, 1.5, 1.7678, 2.25),
    0.5: (2.25, 2.4749, 3.0, 3.8891, 5.25),
    2: (1.3125, 1.149, 1.125, 1.2374, 1.5),
}


def said(what, difference, bound):
    print(f"{what:75s} {difference:9.1e}  (allowed {bound:.0e})")
    assert difference <= bound, what


def plain(law, form=EULER, h=TEN_SECONDS, a=A, **more):
    return Loop(law, form, h, a, **{**GAINS, **more}, lo=-np.inf)


def published_vectors():
    """To the last printed digit."""
    t = np.concatenate([[0], TIMES])
    y = continuous(plain(CONVENTIONAL), t, B)[1:, 0]
    said("conventional, continuous, published vector", np.abs(y - CONVENTIONAL_Y).max(), 0.51e-7)
    exact = (np.exp(-2 * t[1:]) - np.exp(-20 * t[1:])) / 18
    said("the same beside its closed form", np.abs(y - exact).max(), 1e-10)
    peak = np.log(10) / 18
    said(
        "its peak",
        max(abs(peak - 0.12792) / 100, abs((np.exp(-2 * peak) - np.exp(-20 * peak)) / 18 - 0.038713)),
        0.51e-6,
    )
    for law in (CASCADE, CLF):
        x = continuous(plain(law), t, B)[1:]
        seen = np.column_stack([x[:, 0], x[:, 1], x[:, 1] - x[:, 4], x[:, 5]])
        said(f"law {law}, continuous, published vectors", np.abs(seen - TWO[law]).max(), 0.51e-6)
    x = continuous(plain(CASCADE), np.array([0, 0.1, 1]), (1.0, 2.0))
    seen = np.array([*x[1, [0, 1, 4, 5]], *x[2, [0, 1, 5]]])
    said(
        "cascade, matched loads",
        np.abs(seen - [0.028907, 0.057813, -0.009060, -1.056224, -0.005229, -0.010458, -0.994121]).max(),
        0.51e-6,
    )
    for law, vectors in EULER_VECTORS.items():
        x = stepped(plain(law), 400, lambda _: B)
        said(
            f"law {law}, Euler, 10 s, published vectors",
            max(abs(x[round(time * 360), column] - value) for column, time, value in vectors),
            0.51e-6,
        )


def published_anti_windup():
    """u within +-0.5, the load 1 for an hour, explicit Euler with 1e-4 h. The published numbers come out to their last digit where
    the plant is stepped before the observer; with the page's order they move by a step or two of the integration."""
    published = {
        True: (1.515, [(1, 0.507), (1.5, 0.257), (2, 0.094), (2.5, 0.035)]),
        False: (3.86, [(1, 0.507), (1.5, 0.257), (3, -0.49)]),
    }
    for knows, (leaves, vector) in published.items():
        for plant_first in (False, True):
            loop = Loop(CONVENTIONAL, EULER, 1e-4, A, **GAINS, lo=-0.5, hi=0.5)
            y, rows = 0.0, []
            for k in range(50000):
                u = loop.step(y, 0.0, 0.0)
                us = min(max(u, -0.5), 0.5)
                rows.append((y, us))
                y += loop.h * (us + (k < 10000))
                loop.t1 = y if plant_first else loop.t1
                loop.took_effect(us if knows else u)
            rows = np.array(rows)
            slack = 0 if plant_first else 1e-3  # of time; of y at 0.5 1/h half as much
            said(
                f"anti-windup, observer told: {knows}, plant first: {plant_first}",
                max(abs(rows[round(t * 1e4), 0] - y) for t, y in vector),
                (0.51e-3 if knows else 0.51e-2) + slack / 2,
            )
            left = (1 + np.flatnonzero(np.abs(rows[:, 1]) >= 0.5)[-1]) * 1e-4
            said("  leaves the limit for good", abs(left - leaves), (0.51e-3 if knows else 0.51e-2) + slack)


def linear(f, n):
    """Matrix of a linear f of n numbers."""
    return np.column_stack([f(row) for row in np.eye(n)])


def controller_matrices(law, a, kc, kc2, ko1, ko2):
    """[x1, x2, T2*] and [y1, y2, u_s - u, u*_s - u*] to the rates of the first and to [u*, u~], from the page's equations."""

    def run(v):
        loop = Loop(law, EULER, 1.0, a, kc, kc2, ko1, np.inf, -np.inf, ko2)
        loop.x1, loop.x2, loop.t2s = v[:3]
        loop.step(v[3], v[4], 0.0)
        us, ups = loop.u + v[5], loop.up + v[6]
        rates = [
            -ko1 * (loop.x1 + a[0] * us + ko1 * v[3]),
            -ko2 * (loop.x2 + a[1] * us + ko2 * v[4]),
            a[1] * ups + loop.b2,
        ]
        return np.array([*rates, loop.up, loop.ut])

    m = linear(run, 7)
    return m[:3, :3], m[:3, 3:], m[3:, :3], m[3:, 3:]


def printed_matrices(law, a, kc, kc2, ko1, ko2):
    """Frau's Remarks 4.4 to 4.7 with their signs and ratios repaired."""
    r, clf = a[0] / a[1], float(law == CLF)
    big = np.array([[0, 0, -kc2 * ko1 * r], [ko2 / r, -ko2, -kc2 * ko2], [-1 / r, 1, 0]])
    b = np.array(
        [
            [kc * ko1 + clf * kc2 * ko1 * r * r, kc2 * ko1 * r, -ko1 * a[0], 0],
            [ko2 * ((kc + ko1) / r + clf * kc2 * r), ko2 * (kc2 - ko2), -ko2 * a[1], 0],
            [-(kc + ko1) / r, ko2, 0, a[1]],
        ]
    )
    c = np.array([[-1 / a[0], 0, 0], [0, 0, kc2 / a[1]]])
    d = np.array([[-(kc + ko1) / a[0], 0, 0, 0], [-clf * kc2 * a[0] / a[1] ** 2, -kc2 / a[1], 0, 0]])
    return big, b, c, d


def answers(law, a, kc, kc2, ko1, ko2, s):
    """u and T2* as functions of y1 and e2 (columns), where nothing is limited, at the complex frequency s. From y1 and y2 it is
    (sI - A)^-1 B; y2 = e2 + T2* takes T2* back out."""
    big, b, c, d = controller_matrices(law, a, kc, kc2, ko1, ko2)
    x = np.linalg.solve(s * np.eye(3) - big, b[:, :2])
    u = np.sum(c @ x + d[:, :2], axis=0)
    star = x[2]
    y2 = np.array([star[0], 1.0]) / (1 - star[1])  # of y1 and of e2
    return np.array([u[0] + u[1] * y2[0], u[1] * y2[1]]), y2 - [0, 1], u


def closed_forms(law, a, kc, kc2, ko1, ko2, s):
    """u and T2* of y1 and e2 in PI-like form, (4.34) to (4.41) and (4.62) repaired."""
    r, q, clf = a[0] / a[1], 1 / s, float(law == CLF)
    gain = (kc + ko1 + clf * kc2 * r * r) / a[0]
    u = np.array([-gain - q * ko1 * (kc + clf * kc2 * r * r) / a[0], -kc2 / a[1] * (1 + ko1 * q)])
    star = np.array(
        [
            -(kc + ko1) / r * q - (kc * ko1 / r - clf * kc2 * (ko2 - ko1) * r) * q * q,
            ko2 * q + kc2 * (ko2 - ko1) * q * q,
        ]
    )
    return u, star


def collapsed(law, a, kc, kc2, ko, s):
    """u of y1 and y2 where both observers have the same Ko."""
    q, r = 1 / s, a[0] / a[1]
    y1 = -(kc + ko + (kc * ko + kc * kc2 + kc2 * ko) * q + kc * kc2 * ko * q * q) / a[0]
    return np.array([y1 - (law == CLF) * kc2 * r * r / a[0] * (1 + ko * q), -kc2 / a[1]])


def state_space_and_closed_forms(random):
    worst = np.zeros(4)
    for _ in range(200):
        law = random.choice([CASCADE, CLF])
        a = random.uniform(0.2, 3, 2) * random.choice([-1, 1], 2)
        kc, kc2, ko1, ko2 = random.uniform(0.3, 20, 4)
        s = complex(*random.uniform(-5, 5, 2)) + 0.5
        ours, theirs = controller_matrices(law, a, kc, kc2, ko1, ko2), printed_matrices(law, a, kc, kc2, ko1, ko2)
        worst[0] = max(worst[0], *(np.abs(x - y).max() / (1 + np.abs(y).max()) for x, y in zip(ours, theirs)))
        poly = s * (s * s + ko2 * s + kc2 * (ko2 - ko1))
        determinant = np.linalg.det(s * np.eye(3) - ours[0])
        worst[1] = max(worst[1], abs(determinant - poly) / (1 + abs(poly)))
        u, star, _ = answers(law, a, kc, kc2, ko1, ko2, s)
        form = closed_forms(law, a, kc, kc2, ko1, ko2, s)
        worst[2] = max(
            worst[2],
            np.abs(u - form[0]).max() / np.abs(form[0]).max(),
            np.abs(star - form[1]).max() / np.abs(form[1]).max(),
        )
        of_y2 = answers(law, a, kc, kc2, ko1, ko1, s)[2]
        short = collapsed(law, a, kc, kc2, ko1, s)
        worst[3] = max(worst[3], np.abs(of_y2 - short).max() / np.abs(short).max())
    for what, difference in zip(
        ("state-space matrices", "their determinant", "PI-like forms of u and T2*", "collapsed forms"), worst
    ):
        said(what + ", 200 random cases", difference, 1e-9)


def steps_of_the_collapsed_forms(random):
    """Euler keeps the eliminations: three states beside the sums, on noise."""
    worst = 0.0
    for law in (CASCADE, CLF):
        a, (kc, kc2, ko), h = (-0.7, -1.3), random.uniform(1, 5, 3), 0.01
        loop, r = Loop(law, EULER, h, a, kc, kc2, ko, lo=-np.inf), -0.7 / -1.3
        single = double = 0.0
        for t1, t2 in random.standard_normal((200, 2)):
            u = (
                -((kc + ko) * t1 + (kc * ko + kc * kc2 + kc2 * ko) * single + kc * kc2 * ko * double) / a[0]
                - kc2 / a[1] * t2
            )
            u -= (law == CLF) * kc2 * r * r / a[0] * (t1 + ko * single)
            worst = max(worst, abs(loop.step(t1, t2, 0.0) - u))
            loop.took_effect(loop.u)
            double += h * single
            single += h * t1
    said("collapsed forms in Euler steps, on noise", worst, 1e-9)


def equal_to_pi(random):
    """Conventional beside a PI with back-calculation and setpoint weight, limits that come and go."""
    a, (kc, ko), h = -0.7, (2.0, 20.0), 0.005
    loop = Loop(CONVENTIONAL, EULER, h, (a, 1.0), kc, 1.0, ko, lo=-np.inf)
    kp, ti, tt, weight = (kc + ko) / a, (kc + ko) / (kc * ko), 1 / ko, kc / (kc + ko)
    integral, worst, w = 0.0, 0.0, 0.0
    for k, t1 in enumerate(np.cumsum(0.1 * random.standard_normal(2000))):
        w = random.uniform(-1, 1) if k % 100 == 0 else w
        u = kp * (weight * w - t1) + integral
        # From chi = 0: the integral begins as if the weight had always been there.
        us = min(max(u, -1.5), 1.2)
        worst = max(worst, abs(loop.step(t1, 0.0, w) - u) / (1 + abs(u)))
        loop.took_effect(us)
        integral += h * (kp / ti * (w - t1) + (us - u) / tt)
    said("conventional = PI with back-calculation, weight Kc/(Kc + Ko)", worst, 1e-10)


def poles_of_plant_and_controller():
    for law, wanted in (
        (CONVENTIONAL, (-20, -2)),
        (CASCADE, (-20, -20, -4, -2, 0)),
        (CLF, (-20, -20, -5.56155, -1.43845, 0)),
    ):
        loop = plain(law, h=1.0)

        def rate(x):
            loop.x1, loop.x2, loop.t2s = x[2:]
            u = loop.step(x[0], x[1], 0.0)
            loop.took_effect(u)
            return np.array([loop.a1 * u, loop.a2 * u, *(np.array([loop.x1, loop.x2, loop.t2s]) - x[2:])])

        m = linear(rate, 5)
        if law == CONVENTIONAL:
            m = m[np.ix_([0, 2], [0, 2])]
        # -20 is there twice, which doubles only to half the digits.
        said(
            f"law {law}: poles of plant and controller", np.abs(np.sort(np.linalg.eigvals(m).real) - wanted).max(), 6e-6
        )


def predictions(random):
    worst = 0.0
    for q, row in DAMPING.items():
        for p, xi in zip((0.25, 0.5, 1, 2, 4), row):
            poles = np.linalg.eigvals(transition_rate(CASCADE if q is None else CLF, 1.0, p, 1 if q is None else 1 / q))
            worst = max(worst, abs(-poles.sum().real / 2 / np.sqrt(poles.prod().real) - xi), abs(poles.prod().real - p))
    said("damping and frequency, published table", worst, 0.51e-4)
    worst = 0.0
    for kc, kc2, a1, a2, y1, e2, b1, b2 in random.uniform(0.2, 4, (200, 8)) * random.choice([-1, 1], (200, 8)):
        kc, kc2 = abs(kc), abs(kc2)
        loop = Loop(CLF, EULER, 1.0, (a1, a2), kc, kc2, 1.0, lo=-np.inf)
        loop.b1, loop.b2 = b1, b2
        up, ut = loop.actions(y1, e2)
        falls = y1 * (a1 * (up + ut) + b1) + e2 * (a2 * (up + ut) + b2 - a2 * up - b2)
        said_to = -kc * y1**2 - kc2 * (a1 / a2 * y1 + e2) ** 2
        worst = max(worst, abs(falls - said_to) / (1 + abs(said_to)))
    said("Lyapunov function: its rate is what (4.54) has", worst, 1e-10)


def joint_form():
    """Poles of one step of plant and controller, and what even rises leave."""
    worst, offset = 0.0, 0.0
    for law in LAWS:
        for h_ko in (0.01, 0.3, 1, 2, 5):
            h = h_ko / GAINS["ko"]

            def one(x):
                loop = plain(law, JOINT, h)
                loop.x1, loop.x2, loop.t2s = x[2:]
                u = loop.step(x[0], x[1], 0.0)
                loop.took_effect(u)
                return np.array([x[0] + h * loop.a1 * u, x[1] + h * loop.a2 * u, loop.x1, loop.x2, loop.t2s])

            m, slow = (
                linear(one, 5),
                np.exp(h * np.linalg.eigvals(transition_rate(law, GAINS["kc"], GAINS["kc2"], 0.5))),
            )
            wanted = [slow.min(), slow.max(), 1.0, np.exp(-h_ko), np.exp(-h_ko)]
            if law == CONVENTIONAL:
                m, wanted = m[np.ix_([0, 2], [0, 2])], [np.exp(-h * GAINS["kc"]), np.exp(-h_ko)]
            # Characteristic polynomials: a pole that is there twice would lose half the digits.
            worst = max(worst, np.abs(np.poly(m) - np.poly(wanted)).max())
            end = stepped(plain(law, JOINT, h), int(30 / h), lambda _: B)[-1]
            offset = max(offset, abs(end[0]), abs(end[2]) * (law != CONVENTIONAL))
    said("joint form: poles, sampled up to 5/Ko", worst, 1e-9)
    said("joint form: offset of y1, e2 while T2 rises for 30 h", offset, 1e-9)
    for law in LAWS:
        t = np.linspace(0, 1, 11)
        fine, joint = continuous(plain(law), t, B), stepped(plain(law, JOINT, 1e-5), 100001, lambda _: B)[::10000]
        said(
            f"law {law}: joint form in steps of 0.036 s beside no steps", np.abs(fine[:, :2] - joint[:, :2]).max(), 2e-5
        )


def observers_alone_leave_an_offset():
    """The discretisation the page warns of: the observers exactly, T2* by Euler, T2 rising. Published: -0.0096 for 0.0005."""
    loop, t, phi = plain(CASCADE), [0.0, 0.0], np.exp(-20 * TEN_SECONDS)
    for _ in range(720):
        u = loop.step(*t, 0.0)
        loop.t2s += loop.h * (loop.a2 * loop.up + loop.b2)
        for x, a, i in (("x1", loop.a1, 0), ("x2", loop.a2, 1)):
            setattr(loop, x, phi * getattr(loop, x) - (1 - phi) * (a * u + 20 * t[i]))
            t[i] += loop.h * (a * u + B[i])
    said("observers alone discretised: their offset", abs(t[0] + 0.0096), 0.51e-4)


def euler_goes_over_into_no_steps():
    """First order: a tenth of the step, a tenth of the difference. Limits, and a step of the setpoint, too."""
    for law in LAWS:
        for limits, setpoint in (((-np.inf, np.inf), 0.0), ((-0.8, 0.8), 0.3)):
            t, errors = np.linspace(0, 1.5, 16), []
            loop = Loop(law, EULER, 1.0, A, **GAINS, lo=limits[0], hi=limits[1])
            fine = continuous(loop, t, B, limits, setpoint)
            for h in (1e-3, 1e-4):
                loop = Loop(law, EULER, h, A, **GAINS, lo=limits[0], hi=limits[1])
                coarse = stepped(loop, round(1.5 / h) + 1, lambda _: B, limits, setpoint)[:: round(0.1 / h)]
                errors.append(np.abs(fine[:, :2] - coarse[:, :2]).max())
            said(f"law {law}, limits {limits}: ratio of differences less 0.1", abs(errors[1] / errors[0] - 0.1), 0.02)


def all_checks(seed):
    random = np.random.default_rng(seed)
    published_vectors()
    published_anti_windup()
    equal_to_pi(random)
    poles_of_plant_and_controller()
    predictions(random)
    state_space_and_closed_forms(random)
    steps_of_the_collapsed_forms(random)
    joint_form()
    observers_alone_leave_an_offset()
    euler_goes_over_into_no_steps()
