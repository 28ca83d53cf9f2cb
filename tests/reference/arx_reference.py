"""Models from a record by least squares, instrumental variables and extended least squares, dense and in double, written
from the equations at the head of firmware/identify/arx.h and arx_fit.h without the firmware. Writes arx_data.csv, a record of the column of
Kotyk and Machacek (1995) with noise of its measurements, both inputs excited at once, and arx_cases.csv.

    python3 tests/reference/arx_reference.py

Needs numpy. Results have to be the same again, so the random numbers are numpy's PCG64 with a fixed seed.
"""
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent
A = np.array([[-0.80338, 0.02616], [-1.06726, 0.14709]])
B = np.array([[[0.03851, -0.00386], [-0.01062, -0.00192]], [[0.01262, 0.00316], [-0.01990, 0.00157]]])
SAMPLES, STEP = 200, 1 / 4096  # what is measured is a multiple of the step, which float holds exactly
LS, IV, ELS = range(3)
MOST = 12  # parameters of a case


def record() -> tuple[np.ndarray, np.ndarray]:
    random = np.random.default_rng(17)
    u = np.where(random.random((SAMPLES, 2)) < 0.5, -1.0, 1.0)
    y = np.zeros((SAMPLES, 2))
    for k in range(2, SAMPLES):
        for i in range(2):
            y[k, i] = -A[i] @ y[[k - 1, k - 2], i] + sum(B[i, j] @ u[[k - 1, k - 2], j] for j in range(2))
    noisy = y + 0.005 * random.standard_normal(y.shape)
    return u, np.round(noisy / STEP) * STEP


def before(na, lags, nc):
    return max([na, nc] + [last for _, last in lags])


def regressors(u, y, e, na, lags, nc, constant, start):
    """Rows from `start` on; what lies before the record is 0."""
    def late(x, k):
        return np.concatenate([np.zeros(k), x[:-k]])
    columns = [-late(y, k) for k in range(1, na + 1)]
    columns += [late(u[:, j], k) for j, (first, last) in enumerate(lags) if last for k in range(first, last + 1)]
    columns += [late(e, k) for k in range(1, nc + 1)]
    columns += [np.ones(len(y))] if constant else []
    return np.array(columns).T[start:]


def least_squares(X, y):
    """theta, its standard deviations, and how far theta moves at most when numbers of the size of a row's round by 1."""
    theta = np.linalg.lstsq(X, y, rcond=None)[0]
    e = y - X @ theta
    inverse = np.linalg.inv(X.T @ X)
    spread = np.sqrt(np.diag(inverse))
    moved = np.linalg.norm(X, axis=0) @ np.abs(theta) + np.linalg.norm(y)
    bent = np.abs(inverse) @ np.linalg.norm(X, axis=0) * np.linalg.norm(e)
    return theta, spread * np.sqrt(e @ e / (len(y) - len(theta))), spread * moved + bent


def simulated(u, y, theta, na, lags, constant, start):
    """Output of the model with u alone from `start` on, before that the measured one."""
    x = y.copy()
    for k in range(start, len(y)):
        phi = [-x[k - m] for m in range(1, na + 1)]
        phi += [u[k - m, j] for j, (first, last) in enumerate(lags) if last for m in range(first, last + 1)]
        x[k] = np.dot(phi + ([1.0] if constant else []), theta)
    return x


def instruments(u, y, na, lags, constant):
    start = before(na, lags, 0)
    X = regressors(u, y, y * 0, na, lags, 0, constant, start)
    theta = least_squares(X, y[start:])[0]
    for _ in range(100):
        x = simulated(u, y, theta, na, lags, constant, start)
        Z = regressors(u, x, y * 0, na, lags, 0, constant, start)
        theta = np.linalg.solve(Z.T @ X, Z.T @ y[start:])
    e = y[start:] - X @ theta
    M = np.linalg.inv(Z.T @ X)
    return theta, np.sqrt(np.diag(M @ Z.T @ Z @ M.T) * (e @ e) / (len(e) - len(theta)))


def extended(u, y, na, lags, nc, constant):
    start = before(na, lags, nc)
    first = before(na, lags, 0)
    theta = least_squares(regressors(u, y, y * 0, na, lags, 0, constant, first), y[first:])[0]
    e = np.zeros(len(y))
    e[start:] = (y - np.concatenate([np.zeros(first), regressors(u, y, y * 0, na, lags, 0, constant, first) @ theta]))[start:]
    for _ in range(500):
        X = regressors(u, y, e, na, lags, nc, constant, start)
        theta, sd, _ = least_squares(X, y[start:])
        e = e * 0  # errors one sample ahead, each with those before it
        for k in range(start, len(y)):
            e[k] = y[k] - regressors(u[: k + 1], y[: k + 1], e[: k + 1], na, lags, nc, constant, k)[0] @ theta
    return theta, sd


def padded(values):
    return ",".join(f"{x:.17g}" for x in list(values) + [0.0] * (MOST - len(values)))


def main() -> None:
    u, y = record()
    with open(HERE / "arx_data.csv", "w") as f:
        f.write("# By arx_reference.py: the column of Kotyk and Machacek (1995) with both inputs excited, noise of 0.005 (ours).\nu1,u2,y1,y2\n")
        for k in range(SAMPLES):
            f.write(f"{u[k, 0]:g},{u[k, 1]:g},{y[k, 0]!r},{y[k, 1]!r}\n".replace("np.float64(", "").replace(")", ""))
    two = [(1, 2), (1, 2)]
    cases = [(LS, 0, 2, two, 0, 0), (LS, 1, 2, two, 0, 0), (LS, 0, 1, [(1, 1), (1, 3)], 0, 1), (LS, 1, 0, [(1, 4), (2, 5)], 0, 1),
             (LS, 1, 3, [(2, 3), (0, 0)], 0, 0), (IV, 0, 2, two, 0, 0), (IV, 1, 2, two, 0, 1), (ELS, 0, 1, [(1, 1), (1, 1)], 1, 0),
             (ELS, 1, 1, [(1, 1), (1, 2)], 2, 1)]
    with open(HERE / "arx_cases.csv", "w") as f:
        f.write("# By arx_reference.py: method, output, na, first and last lag of each input, nc, constant; then theta, standard deviations,\n"
                "# and (least squares) how far each theta moves when rows round by 1, 12 of each.\n")
        f.write("method,output,na,first1,last1,first2,last2,nc,constant,theta,sd,moved\n")
        for method, i, na, lags, nc, constant in cases:
            start, moved = before(na, lags, 0), []
            if method == LS:
                theta, sd, moved = least_squares(regressors(u, y[:, i], y[:, i] * 0, na, lags, 0, constant, start), y[start:, i])
            elif method == IV:
                theta, sd = instruments(u, y[:, i], na, lags, constant)
            else:
                theta, sd = extended(u, y[:, i], na, lags, nc, constant)
            head = [method, i, na, *lags[0], *lags[1], nc, constant]
            f.write(",".join(map(str, head)) + "," + ",".join(map(padded, (theta, sd, moved))) + "\n")


if __name__ == "__main__":
    main()
