"""Closed loops of sampled PI controllers on linear plants with dead times, exactly: an independent check of what
firmware/design says of them. Used by loops_reference.py and tests/unit/test_detuned_loops.py.

Inputs are held between samples, so that every element is stepped with its matrix exponential; a dead time of d + f samples
(0 <= f < 1) makes an input act with its old value for the part f of a sample. The whole loop is then one matrix, and it is
stable when the eigenvalues of that matrix are inside the unit circle.
"""
import numpy as np
import scipy.linalg
import scipy.signal


class Part:
    """x' = A x + B u(t - L), y = C x: one element, or a whole state space without dead time."""

    def __init__(self, A, B, C, dead, h, inputs, outputs, D=None):
        self.inputs, self.outputs = inputs, outputs
        n, m = B.shape
        self.whole = int(np.floor(dead / h + 1e-12))
        f = min(max(dead / h - self.whole, 0.0), 1.0)
        both = np.zeros((n + m, n + m))
        both[:n, :n], both[:n, n:] = A, B
        e = scipy.linalg.expm(both * h)
        late = scipy.linalg.expm(both * h * (1.0 - f))
        self.Ad = e[:n, :n]
        self.new = late[:n, n:]  # by the value that rules at the end of the sample
        self.old = e[:n, n:] - self.new  # by the one before: what is left of the whole
        self.C = C
        self.D = np.zeros((C.shape[0], m)) if D is None else D


def fopdt_parts(gain, dead, constant, h):
    """An element of time constant 0 answers within the sample: its lag is taken as h / 100."""
    out = []
    for i in range(gain.shape[0]):
        for j in range(gain.shape[1]):
            if gain[i, j] != 0.0:
                T = max(constant[i, j], h * 0.01)
                out.append(Part(np.array([[-1.0 / T]]), np.array([[1.0 / T]]), np.array([[gain[i, j]]]), dead[i, j], h,
                                [j], [i]))
    return out


def plant_parts(q, h):
    """Transfer functions of linear_reference.Plant, gains in spans."""
    m, p = len(q.j["inputs"]), len(q.outputs)
    span = lambda c: c["hi"] - c["lo"]
    scale = np.array([[span(u) / span(y) for u in q.inputs[:m]] for y in q.outputs])
    if q.j["model"] == "transfer":
        out = []
        for i in range(p):
            for j in range(m):
                e = q.elements[i][j]
                if not e:
                    continue
                den = np.real(np.poly(e.poles))
                num = e.gain * scale[i, j] * np.real(np.prod([-s for s in e.poles])) * np.array([e.zero, 1.0])
                A, B, C, _ = scipy.signal.tf2ss(num if e.zero else num[1:], den)
                out.append(Part(A, B, C, e.dead, h, [j], [i]))
        return out
    if q.j["model"] == "state_space":
        rows = np.array([1.0 / span(y) for y in q.outputs])[:, None]
        cols = np.array([span(u) for u in q.inputs[:m]])[None, :]
        return [Part(q.A, q.B[:, :m] * cols, q.C * rows, 0.0, h, list(range(m)), list(range(p)), q.D[:, :m] * rows * cols)]
    raise ValueError(f"{q.name}: a {q.j['model']} plant has a period of its own")


class Loop:
    def __init__(self, parts, pairs, gain, ti, h, decoupler=None):
        self.parts, self.h = parts, h
        self.outputs, self.inputs = [a for a, _ in pairs], [b for _, b in pairs]
        self.gain, self.ti = np.asarray(gain), np.asarray(ti)
        self.D = np.eye(len(pairs)) if decoupler is None else np.asarray(decoupler)
        self.p = 1 + max(max(q.outputs) for q in parts)
        self.m = 1 + max(max(q.inputs) for q in parts)
        self.length = 2 + max(q.whole for q in parts)  # samples of every input that are remembered
        self.sizes = [len(q.Ad) for q in parts]
        self.order = sum(self.sizes) + self.m * self.length + len(pairs)

    def split(self, s):
        at, x = 0, []
        for n in self.sizes:
            x.append(s[at:at + n])
            at += n
        past = s[at:at + self.m * self.length].reshape((self.length, self.m) + s.shape[1:])
        return x, past, s[at + self.m * self.length:]

    def outputs_of(self, s):
        x, past, _ = self.split(s)
        y = np.zeros((self.p,) + s.shape[1:])
        for q, xq in zip(self.parts, x):
            y[q.outputs] += q.C @ xq + q.D @ past[q.whole][q.inputs]
        return y

    def step(self, s, setpoint=None, load=None, b=1.0):
        """One sample; s may hold many states side by side."""
        x, past, integral = self.split(s)
        y = self.outputs_of(s)[self.outputs]
        r = np.zeros_like(y) if setpoint is None else setpoint
        k = self.gain.reshape((-1,) + (1,) * (s.ndim - 1))
        v = k * (b * r - y) + integral
        integral = integral + k * self.h / self.ti.reshape(k.shape) * (r - y)
        u = np.zeros((self.m,) + s.shape[1:])
        u[self.inputs] = self.D @ v
        moved = u.copy()
        if load is not None:
            u = u + load
        past = np.concatenate([u[None], past[:-1]])
        x = [q.Ad @ xq + q.new @ past[q.whole][q.inputs] + q.old @ past[q.whole + 1][q.inputs]
             for q, xq in zip(self.parts, x)]
        return np.concatenate([*x, past.reshape((-1,) + s.shape[1:]), integral]), moved

    def radius(self):
        """Largest |eigenvalue| of the closed loop; below 1: stable."""
        return np.abs(np.linalg.eigvals(self.step(np.eye(self.order))[0])).max()

    def simulate(self, steps, setpoint=None, load=None, b=1.0):
        """Outputs after each sample, and the inputs asked for."""
        s = np.zeros(self.order)
        y, u = np.zeros((steps, self.p)), np.zeros((steps, self.m))
        for n in range(steps):
            s, u[n] = self.step(s, setpoint, load, b)
            y[n] = self.outputs_of(s)
        return y, u
