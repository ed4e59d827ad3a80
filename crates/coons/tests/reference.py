"""Prints tests/reference.txt: partials of fills to third order, to 20 digits, from formulas (1) and (2) as printed.

    python3 crates/coons/tests/reference.py > crates/coons/tests/reference.txt

Needs mpmath. Derivatives are differences in 80 digits: nothing of the crate's formulas for derivatives enters.
"""
from mpmath import cos, diff, exp, matrix, mp, mpf, pi, sin

mp.dps = 80
V = lambda *x: matrix([mpf(c) for c in x])


def S1(u, v):
    return V(u + sin(v) / 10, v + u**2 / 20, mpf(4) / 10 * sin(mpf(13) / 10 * u + mpf(2) / 10) * cos(mpf(9) / 10 * v) + mpf(15) / 100 * v**2)


def S2(u, v):
    return V(u + mpf(8) / 100 * v * (1 - v), v + mpf(3) / 100 * cos(2 * u), mpf(3) / 10 * cos(mpf(7) / 10 * u) * exp((v - 1) / 2) - mpf(2) / 10 * u * v)


def D(S, u, v, n):
    return matrix([diff(lambda x: S(u, x)[i], v, n) for i in range(3)]) if n else S(u, v)


def hermite(start, end):
    H = [lambda t: 1 - 10 * t**3 + 15 * t**4 - 6 * t**5, lambda t: t - 6 * t**3 + 8 * t**4 - 3 * t**5, lambda t: (t**2 - 3 * t**3 + 3 * t**4 - t**5) / 2]
    return lambda v: sum((H[j](v) * start[j] + (-1) ** j * H[j](1 - v) * end[j] for j in range(3)), V(0, 0, 0))


def border(u, bump):
    h = hermite([D(S1, u, mpf(0), j) for j in range(3)], [D(S2, u, mpf(1), j) for j in range(3)])
    return lambda v: h(v) + v**3 * (1 - v) ** 3 * bump


C3, C4 = border(mpf(0), V(1, -2, 4)), border(mpf(1), V(-1, 1, -3))
trig1 = lambda t: sin(pi * t / 2) ** 2
s = lambda t: (1 - 2 * t) ** 3 * sin(pi * (2 * t + 1)) ** 2 / 16
rat1 = lambda t: 4 * t**2 / (1 + t**2) ** 2
blends = {
    "trig1": trig1,
    "trig2": lambda t: trig1(t) - s(t),
    "trig3": lambda t: trig1(t) ** 2 * (3 - 2 * trig1(t)),
    "poly2": lambda t: 10 * t**3 - 15 * t**4 + 6 * t**5,
    "poly3": lambda t: 35 * t**4 - 84 * t**5 + 70 * t**6 - 20 * t**7,
    "rat2": lambda t: rat1(t) - t**2 * (1 - t) ** 2 * (4 - 5 * t),
    "ratsym2": lambda t: t**3 / (t**3 + (1 - t) ** 3),
}


def four(alpha, beta):
    def f(u, v):
        a, b = alpha(u), beta(v)
        q = ((1 - b) * S1(0, v) + b * S2(0, v)) * (1 - a) + ((1 - b) * S1(1, v) + b * S2(1, v)) * a
        return (1 - b) * S1(u, v) + b * S2(u, v) + (1 - a) * C3(v) + a * C4(v) - q

    return f


def T1(u, v):
    p, q = pi * u / 2, pi * v / 2
    return V(sin(p) * cos(q), mpf(8) / 10 * sin(p) * sin(q), cos(p))


def T2(u, v):
    p, q = pi * u / 2, pi * v / 2
    return V(mpf(12) / 10 * sin(p) * cos(q), sin(p) * sin(q), mpf(9) / 10 * cos(p) + mpf(1) / 10)


def T3(u, v):
    q, b = pi * v / 2, 3 * v**2 - 2 * v**3
    return V(cos(q), sin(q), (1 - b) * (pi / 2) * (1 - u) + b * (mpf(45) / 100 * pi * (1 - u) + mpf(1) / 10))


def three(alpha, beta):
    def f(u, v):
        a, b = alpha(u), beta(v)
        q = a * (1 - b) * (T3(u, mpf(0)) - T1(u, mpf(0))) + a * b * (T3(u, mpf(1)) - T2(u, mpf(1)))
        return (1 - a) * (1 - b) * T1(u, v) + (1 - a) * b * T2(u, v) + a * T3(u, v) - q

    return f


def emit(kind, a, b, f):
    for u, v in [("0.3", "0.4"), ("0.75", "0.125"), ("0.0625", "0.96875")]:
        for i, j in [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2), (3, 0), (2, 1), (1, 2), (0, 3)]:
            at = (mpf(u), mpf(v))
            value = [diff(lambda x, y: f(x, y)[k], at, (i, j)) if i + j else f(*at)[k] for k in range(3)]
            print(kind, a, b, u, v, i, j, *(mp.nstr(x, 20) for x in value))


for a, b in [("trig1", "trig1"), ("trig1", "trig2"), ("poly2", "poly2"), ("poly3", "poly3"), ("trig3", "rat2"), ("rat2", "ratsym2")]:
    emit("A", a, b, four(blends[a], blends[b]))
for a, b in [("trig1", "trig1"), ("poly2", "trig2")]:
    emit("D", a, b, three(blends[a], blends[b]))
